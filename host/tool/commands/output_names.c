#define _DEFAULT_SOURCE /* strdup */
#include "commands/output_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/exit_code.h"
#include "cli/message.h"
#include "cli/output_file.h"
#include "host/system/files.h"

/* Copies the folders and the name in `path` up to `end`, without a leading slash and folders "."; returns the length.
 * Each of them is followed by a slash but the last. */
static size_t copy_below(char *copy, const char *path, const char *end) {
    size_t length = 0;
    while (path < end) {
        const char *slash = memchr(path, '/', (size_t)(end - path));
        const size_t size = (size_t)((slash ? slash : end) - path);
        if (size > 0 && !(slash && size == 1 && *path == '.')) {
            memcpy(copy + length, path, size);
            length += size;
            if (slash)
                copy[length++] = '/';
        }
        path += size + 1;
    }
    return length;
}

static bool has_parent_folder(const char *path) {
    for (;;) {
        const size_t size = strcspn(path, "/");
        if (size == 2 && strncmp(path, "..", 2) == 0)
            return true;
        if (path[size] == '\0')
            return false;
        path += size + 1;
    }
}

/* Why an input has no output, or NULL. */
static const char *naming_problem(const output_naming *naming, const char *input) {
    const size_t length = strlen(input);
    if (length > 0 && input[length - 1] == '/')
        return "is a folder, not an image; name its files";
    if (naming->keep_tree && has_parent_folder(input))
        return "has the folder .. in its name, and its output would be outside of --out-dir; name it from a folder "
               "above";
    return NULL;
}

/* DIR/NAME.gscl for PATH/NAME.png, or DIR/PATH/NAME.gscl; without DIR, PATH/NAME.gscl. */
static char *join_name(const output_naming *naming, const char *input) {
    const char *out_dir = naming->out_dir, *slash = strrchr(input, '/'), *end = name_suffix(input);
    const char *start = out_dir && slash && !naming->keep_tree ? slash + 1 : input;
    const size_t folder = out_dir ? strlen(out_dir) + 1 : 0, most = (size_t)(end - start);
    const size_t suffix = strlen(naming->suffix) + 1;
    char *name = malloc(folder + most + suffix);
    if (!name)
        return NULL;
    if (out_dir)
        snprintf(name, folder + 1, "%s/", out_dir);
    size_t length = most;
    if (out_dir && naming->keep_tree)
        length = copy_below(name + folder, start, end);
    else
        memcpy(name + folder, start, most);
    memcpy(name + folder + length, naming->suffix, suffix);
    return name;
}

char *output_name_make(const output_naming *naming, const char *input, const char **problem) {
    *problem = naming->output ? NULL : naming_problem(naming, input);
    if (*problem)
        return NULL;
    char *name = naming->output ? strdup(naming->output) : join_name(naming, input);
    if (!name)
        *problem = gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY);
    return name;
}

void output_names_free(char **names, int count) {
    for (int i = 0; names && i < count; i++)
        free(names[i]);
    free(names);
}

static bool overwrites_input(char *const *inputs, int count, const char *name) {
    for (int i = 0; system_exists(name) && i < count; i++) {
        if (!output_is_separate("encode", inputs[i], name))
            return true;
    }
    return false;
}

static bool are_separate(char *const *inputs, char *const *names, int count) {
    for (int i = 0; i < count; i++) {
        if (overwrites_input(inputs, count, names[i]))
            return false;
        for (int j = 0; j < i; j++) {
            if (strcmp(names[i], names[j]) == 0 && strcmp(names[i], "-") != 0) {
                report_usage("encode", "%s and %s would both be written to %s; encode them into different folders",
                             inputs[j], inputs[i], names[i]);
                return false;
            }
        }
    }
    return true;
}

static int fill_names(const output_naming *naming, char *const *inputs, int count, char **names) {
    const char *problem;
    for (int i = 0; i < count; i++) {
        names[i] = output_name_make(naming, inputs[i], &problem);
        if (!names[i]) {
            report_error(inputs[i], "%s", problem);
            return EXIT_USAGE;
        }
    }
    return are_separate(inputs, names, count) ? EXIT_SUCCESS : EXIT_USAGE;
}

char **output_names_make(const output_naming *naming, char *const *inputs, int count, int *status) {
    char **names = calloc((size_t)count, sizeof *names);
    *status = EXIT_FAILURE;
    if (!names)
        report_error(inputs[0], "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
    else
        *status = fill_names(naming, inputs, count, names);
    if (*status == EXIT_SUCCESS)
        return names;
    output_names_free(names, count);
    return NULL;
}
