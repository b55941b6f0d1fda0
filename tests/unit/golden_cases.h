/* Encodes on the device "host" whose files are the same on every processor with a fused multiply-add, and for any number of
 * threads.  golden.txt has a line for each, in the order of golden_cases: its name, the 64-bit FNV-1a hash of its file, and the
 * PSNR of that in dB. */
#ifndef GSCL_TESTS_GOLDEN_CASES_H
#define GSCL_TESTS_GOLDEN_CASES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

/* Pictures in integer arithmetic. */
typedef enum golden_picture_kind { SCENE, DRAWING, STRIPES, FLAT } golden_picture_kind;

/* Fields that are 0 have the default, but for the effort. */
typedef struct golden_case {
    const char *name;
    golden_picture_kind kind;
    uint32_t width, height, channels;
    int effort;
    gscl_target target;
    double value;
    gscl_sample sample; /* 0: U8 */
    gscl_profile profile;
    gscl_blend blend;
    gscl_loss loss;
    gscl_tune tune;
    uint32_t effects_on, effects_off;
    uint32_t codebook_size;
    double step_factor;
    bool bare, progressive;
    uint32_t packet_size;
} golden_case;

extern const golden_case golden_cases[];
extern const size_t golden_case_count;

/* What an encode made. */
typedef struct golden_file {
    uint8_t *bytes; /* of gscl_free */
    size_t size;
    double psnr; /* dB */
} golden_file;

/* NULL where no case has this name. */
const golden_case *golden_case_named(const char *name);
/* Opens the device "host", as gscl_context_create does. */
gscl_result golden_open(gscl_context **context, int threads);
/* The picture of a case, whose pixels the caller frees with free(); they are NULL where there is no memory. */
gscl_image golden_picture(const golden_case *c);
/* Fails as gscl_encode does; without a message in the context where there is no memory for the picture. */
gscl_result golden_encode(gscl_context *context, const golden_case *c, golden_file *file);
/* 64-bit FNV-1a of a file's bytes. */
uint64_t golden_hash(const golden_file *file);

#endif
