/* Takes the place of libFuzzer: gives each file that is named, or that lies in a folder that is named, to a fuzz target. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define MAX_SIZE (1u << 24)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);

/* For custom mutators, which are not called here. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size) {
    (void)data;
    (void)max_size;
    return size;
}

/* The input gets memory of its own size, so that a sanitizer sees reads beyond it. */
static void replay_file(const char *path) {
    static uint8_t bytes[MAX_SIZE];
    FILE *file = fopen(path, "rb");
    if (!file) {
        perror(path);
        exit(EXIT_FAILURE);
    }
    const size_t size = fread(bytes, 1, MAX_SIZE, file);
    fclose(file);
    uint8_t *exact = malloc(size > 0 ? size : 1);
    if (!exact)
        abort();
    for (size_t i = 0; i < size; i++)
        exact[i] = bytes[i];
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
}

static unsigned replay_folder(DIR *folder, const char *path) {
    unsigned files = 0;
    for (const struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
        char file[4096];
        if (entry->d_name[0] == '.')
            continue;
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
        replay_file(file);
        files++;
    }
    closedir(folder);
    return files;
}

int main(int count, char **words) {
    unsigned files = 0;
    for (int i = 1; i < count; i++) {
        DIR *folder = opendir(words[i]);
        if (!folder)
            replay_file(words[i]);
        files += folder ? replay_folder(folder, words[i]) : 1;
    }
    printf("%u inputs\n", files);
    return files > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
