#define _DEFAULT_SOURCE /* strdup, access */
#include "commands/output_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/message.h"
#include "cli/output_file.h"

/* DIR/NAME.gscl for PATH/NAME.png; without DIR, PATH/NAME.gscl.  NULL when out of memory. */
static char *make_output_name(const char *input, const char *out_dir, const char *suffix) {
    const char *slash = strrchr(input, '/');
    const char *start = out_dir && slash ? slash + 1 : input;
    const int stem = (int)(name_suffix(input) - start);
    const size_t capacity = (out_dir ? strlen(out_dir) + 1 : 0) + (size_t)stem + strlen(suffix) + 1;
    char *name = malloc(capacity);
    if (name)
        snprintf(name, capacity, "%s%s%.*s%s", out_dir ? out_dir : "", out_dir ? "/" : "", stem, start, suffix);
    return name;
}

void output_names_free(char **names, int count) {
    for (int i = 0; names && i < count; i++)
        free(names[i]);
    free(names);
}

char **output_names_make(char *const *inputs, int count, const char *output, const char *out_dir, const char *suffix) {
    char **names = calloc((size_t)count, sizeof *names);
    for (int i = 0; names && i < count; i++) {
        names[i] = output ? strdup(output) : make_output_name(inputs[i], out_dir, suffix);
        if (!names[i]) {
            output_names_free(names, count);
            return NULL;
        }
    }
    return names;
}

static bool overwrites_input(char *const *inputs, int count, const char *name) {
    for (int i = 0; access(name, F_OK) == 0 && i < count; i++) {
        if (!output_is_separate("encode", inputs[i], name))
            return true;
    }
    return false;
}

bool output_names_check(char *const *inputs, char *const *names, int count) {
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
