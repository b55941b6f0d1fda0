#include "codebook/codebook_plan.h"

#include <math.h>

#include "codebook/tunables.h"
#include "runtime/elementary.h"

/* Words grow with the square root of the file, since their cost is shared by more splats. */
static int words_for(double bits) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    return (int)fmin(fmax(rint(t->words_scale * sqrt(bits / t->words_reference_bits)), t->min_words), t->max_words);
}

static int word_bits_for(double bits) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    return bits < t->fine_words_bits ? t->coarse_word_bits : t->fine_word_bits;
}

double gscl_codebook_splats_for(double bits, int shape_words, int colour_words, int word_bits, int colour_dims) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    double books = t->side_bits + word_bits * (3.0 * shape_words + colour_dims * (double)colour_words) -
                   gscl_log2_factorial(shape_words) - gscl_log2_factorial(colour_words);
    double splat_bits = gscl_log2(shape_words) + gscl_log2(colour_words) - t->index_saving + 2 * t->position_bits;
    double n = fmax((bits - books) / splat_bits, 1);
    for (int i = 0; i < 20; i++) /* the order of n splats saves log2 n! bits: a fixed-point iteration */
        n = fmax((bits - books) / (splat_bits - gscl_log2_factorial(n) / n), 1);
    return n;
}

gscl_codebook_plan gscl_codebook_plan_make(const gscl_encoder *e, size_t bytes, size_t splats) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const double bits = bytes ? 8.0 * (double)bytes : t->bits_per_splat * (double)splats;
    const int effort = e->settings.effort, colour_dims = (int)gsf_channel_count(&e->coded.file.header) + 1;
    const int words = e->settings.codebook_size ? (int)e->settings.codebook_size : words_for(bits);
    gscl_codebook_plan p = {.bytes = bytes,
                            .words = {words, words},
                            .word_bits = word_bits_for(8.0 * (double)bytes),
                            .splats = splats,
                            .steps = t->steps[effort],
                            .rounds = t->rounds[effort],
                            .round_steps = t->round_steps[effort]};
    if (bytes) {
        const double fitting = gscl_codebook_splats_for(bits, words, words, p.word_bits, colour_dims);
        p.splats = (size_t)fmin(t->splat_surplus * fitting, (double)e->max_splats) + 1;
    }
    p.first_splats = (size_t)ceil((double)p.splats * t->start_share);
    return p;
}
