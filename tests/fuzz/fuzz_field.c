/* Reads hostile tables of splats as gscl pack does, CSV and PLY.  What is read must be as many splats as it says, all of which can be
 * read, and a blend and steps within their ranges. */
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>

#include "commands/field_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool condition, const char *message) {
    if (!condition) {
        fprintf(stderr, "fuzz: %s\n", message);
        abort();
    }
}

/* Reads all splats, so that memory checkers see whether they are there. */
static void touch(const gscl_field *field) {
    volatile float last = 0;
    for (size_t i = 0; i < field->count; i++)
        last = field->splats[i].x + field->splats[i].wave_amplitude + field->splats[i].colour[3];
    (void)last;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    gscl_field field = {.struct_size = sizeof field};
    char *text = malloc(size > 0 ? size : 1); /* nothing may be read behind it */
    require(text != NULL, "no memory");
    for (size_t i = 0; i < size; i++)
        text[i] = (char)data[i];
    if (field_parse("input", (const uint8_t *)text, size, &field)) {
        require(field.count <= GSCL_MAX_SPLATS, "there are too many splats");
        require(field.blend >= GSCL_BLEND_AUTO && field.blend <= GSCL_BLEND_SUM, "the blend is none");
        require(!field.has_steps || (field.steps.scale <= 15 && field.steps.opacity <= 15 && field.steps.pivot <= 63),
                "the steps are none");
        touch(&field);
    } else {
        require(field.splats == NULL, "splats are left after an error");
    }
    gscl_free(field.splats);
    free(text);
    return 0;
}
