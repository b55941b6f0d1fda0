/* Prints the lines of golden.txt that this build gives: golden [NAME...]
 *
 * Without a name those of all cases: so golden.txt is written anew after a change of what the encoder computes, on a processor
 * with a fused multiply-add. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "golden_cases.h"

/* Prints the line of a case.  Returns whether the encode succeeded. */
static bool print_line(const golden_case *c) {
    gscl_context *context;
    golden_file file = {NULL, 0, 0};
    gscl_result result = golden_open(&context, 0);
    if (result == GSCL_OK)
        result = golden_encode(context, c, &file);
    if (result == GSCL_OK)
        printf("%s %016" PRIx64 " %.2f\n", c->name, golden_hash(&file), file.psnr);
    else
        fprintf(stderr, "golden: %s: %s\n", c->name, gscl_context_message(context));
    fflush(stdout);
    gscl_free(file.bytes);
    gscl_context_free(&context);
    return result == GSCL_OK;
}

static bool print_named(const char *name) {
    const golden_case *c = golden_case_named(name);
    if (!c)
        fprintf(stderr, "golden: no case of this name: %s\n", name);
    return c && print_line(c);
}

int main(int count, char **words) {
    bool good = true;
    for (int i = 1; i < count; i++)
        good = print_named(words[i]) && good;
    for (size_t i = 0; count == 1 && i < golden_case_count; i++)
        good = print_line(&golden_cases[i]) && good;
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
