/* Decodes files in a sandbox in which every system call but those for memory ends the process: sandbox FILE...
 *
 * Of each file its whole and bare forms are decoded, parts of them, and copies with changed bytes.  The results and samples
 * must be those outside the sandbox.  Linux on x86-64 and 64-bit ARM only; skipped elsewhere. */
#define _DEFAULT_SOURCE
#include <stdio.h>

#if !defined(__linux__) || !(defined(__x86_64__) || defined(__aarch64__))
int main(void) {
    puts("skipped: no filter of system calls");
    return 0;
}
#else
#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stdbool.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <gscl/gscl.h>

#ifdef __x86_64__
#define ARCHITECTURE AUDIT_ARCH_X86_64
#else
#define ARCHITECTURE AUDIT_ARCH_AARCH64
#endif
#define MAX_BYTES 20000
#define MAX_RESULTS 64
#define LOAD(offset) BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)(offset))
#define ALLOW BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)
#define KILL BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS)
#define ALLOW_CALL(call) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (call), 0, 1), ALLOW

/* What a process leaves of its decodes; shared by parent and child. */
typedef struct {
    uint64_t hash, decodes, results[MAX_RESULTS];
} record;

typedef struct {
    uint8_t bytes[MAX_BYTES];
    size_t size;
} file;

/* Returns whether the process is in the sandbox now.  mmap may map memory that is neither a file nor executable. */
static bool enter_sandbox(bool with_clock) {
    struct sock_filter filter[] = {
        LOAD(offsetof(struct seccomp_data, arch)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ARCHITECTURE, 1, 0),
        KILL,
        LOAD(offsetof(struct seccomp_data, nr)),
        ALLOW_CALL(SYS_brk),
        ALLOW_CALL(SYS_munmap),
        ALLOW_CALL(SYS_mremap),
        ALLOW_CALL(SYS_madvise),
        ALLOW_CALL(SYS_exit),
        ALLOW_CALL(SYS_exit_group),
        ALLOW_CALL(with_clock ? SYS_clock_gettime : SYS_exit),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_mmap, 1, 0),
        KILL,
        LOAD(offsetof(struct seccomp_data, args[2])),
        BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, PROT_EXEC, 3, 0),
        LOAD(offsetof(struct seccomp_data, args[3])),
        BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, MAP_ANONYMOUS, 0, 1),
        ALLOW,
        KILL,
    };
    const struct sock_fprog program = {sizeof filter / sizeof *filter, filter};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

static void add_to_hash(record *r, const void *bytes, size_t size) {
    for (size_t i = 0; i < size; i++)
        r->hash = (r->hash ^ ((const uint8_t *)bytes)[i]) * 1099511628211u;
}

/* In memory of the exact size, with limits that keep a changed file from taking long. */
static void decode(gscl_context *context, const uint8_t *bytes, size_t size, bool bare, record *r) {
    gscl_decode_settings settings;
    gscl_image image = {0};
    gscl_decode_settings_default(&settings);
    settings.bare = bare;
    settings.max_pixels = 200000;
    settings.max_work = 3000000;
    const gscl_result result = gscl_decode(context, bytes, size, &settings, &image);
    r->decodes++;
    r->results[result < MAX_RESULTS ? result : 0]++;
    add_to_hash(r, &result, sizeof result);
    if (result == GSCL_OK)
        add_to_hash(r, image.pixels, (size_t)image.width * image.height * image.channels);
    gscl_free(image.pixels);
}

static void decode_form(gscl_context *context, file f, bool bare, record *r) {
    uint32_t random = 1;
    decode(context, f.bytes, f.size, bare, r);
    for (size_t i = 0; i < 8; i++)
        decode(context, f.bytes, f.size * i / 8, bare, r);
    for (int i = 0; i < 24 && f.size > 0; i++) {
        random = random * 1664525u + 1013904223u;
        const size_t at = (random >> 8) % f.size;
        const uint8_t kept = f.bytes[at];
        f.bytes[at] ^= (uint8_t)(1u << i % 8);
        decode(context, f.bytes, f.size, bare, r);
        f.bytes[at] = kept;
    }
}

static void decode_files(const file *files, int count, record *r) {
    gscl_context *context = NULL;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    const bool opened = gscl_context_create(&context, &settings) == GSCL_OK;
    for (int i = 0; opened && i < count; i++) {
        decode_form(context, files[i], false, r);
        if (files[i].size < 7 || files[i].bytes[4] != 2)
            continue;
        file picture = {.size = files[i].size - 7};
        memcpy(picture.bytes, files[i].bytes + 5, picture.size);
        decode_form(context, picture, true, r);
    }
    gscl_context_free(&context);
}

enum { FILES, CLOCK, OTHER };

/* Returns how a process in the sandbox ended that decoded the files, read the clock, or made another call. */
static int status_of(int task, bool with_clock, const file *files, int count, record *r) {
    int status;
    struct timespec now;
    const pid_t child = fork();
    if (child == 0) {
        if (!enter_sandbox(with_clock))
            _exit(errno == EINVAL || errno == ENOSYS || errno == EPERM ? 77 : 1);
        if (task == FILES)
            decode_files(files, count, r);
        else if (task == CLOCK)
            clock_gettime(CLOCK_MONOTONIC, &now);
        else
            getppid();
        _exit(0);
    }
    return child > 0 && waitpid(child, &status, 0) == child ? status : -1;
}

static bool is_killed(int status) {
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS;
}

static int check(const file *files, int count) {
    record outside = {.hash = 14695981039346656037u};
    record *inside = mmap(NULL, sizeof *inside, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (inside == MAP_FAILED)
        return 1;
    *inside = outside;
    const int other = status_of(OTHER, false, NULL, 0, NULL);
    if (WIFEXITED(other) && WEXITSTATUS(other) == 77) {
        puts("skipped: the kernel takes no filter of system calls");
        return 0;
    }
    if (!is_killed(other)) {
        puts("the sandbox allows other calls");
        return 1;
    }
    /* The clock is no call where the kernel lets a process read it from memory. */
    const bool with_clock = is_killed(status_of(CLOCK, false, NULL, 0, NULL));
    decode_files(files, count, &outside);
    const int status = status_of(FILES, with_clock, files, count, inside);
    printf("%d decodes, %d of them drawn, %d corrupt, %d truncated\n", (int)inside->decodes,
           (int)inside->results[GSCL_OK], (int)inside->results[GSCL_ERROR_CORRUPT],
           (int)inside->results[GSCL_ERROR_TRUNCATED]);
    if (is_killed(status))
        printf("decode %d makes a system call other than for memory\n", (int)inside->decodes + 1);
    if (status != 0 || memcmp(inside, &outside, sizeof outside) != 0) {
        puts("the results in the sandbox are not those outside");
        return 1;
    }
    const uint64_t *results = inside->results;
    return results[GSCL_OK] == 0 || results[GSCL_ERROR_CORRUPT] == 0 || results[GSCL_ERROR_TRUNCATED] == 0;
}

int main(int count, char **words) {
    static file files[256];
    int read = 0;
    for (int i = 1; i < count && read < 256; i++) {
        FILE *stream = fopen(words[i], "rb");
        if (!stream)
            return 1;
        files[read].size = fread(files[read].bytes, 1, MAX_BYTES, stream);
        read += feof(stream) != 0;
        fclose(stream);
    }
    return check(files, read);
}
#endif
