/* The paper profile: Zhang et al., "2D Gaussian Splatting for Image Compression".
 *
 * A free fit under alpha blending with births and deaths (P1-P4, P7), K-means codebooks learnt straight through
 * (P5), then rounds in which words are chosen by rate and distortion and learnt for the picture, and b-bit
 * quantisation (P8).  Entropy coding (P9) is the format's. */
#include "codebook/encode_codebook.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "codebook/codebook.h"
#include "cl/constants.h"
#include "fit/density.h"
#include "session/encoder.h"
#include "decode/quantise.h"
#include "session/encode_trace.h"
#include "runtime/timing.h"

#define START_SHARE 0.3     /* of the splats are there at the first step */
#define GROW_ROUNDS 10      /* in which the others are added */
#define GROW_UNTIL 0.6      /* of the steps */
#define REPLENISH_AT 0.75   /* of the steps: those that have faded away since then are replaced */
#define QUARTER_UNTIL 0.45  /* of the steps at a quarter of the size, */
#define HALF_UNTIL 0.85     /* then at half the size, the rest at full size */
#define THROUGH_FROM 0.92   /* of the steps: from then on straight through the codebooks */
#define CLUSTER_INTERVAL 20 /* steps between clusterings */
#define SORT_INTERVAL 10    /* steps between sortings of the free fit */
#define RATE 2.0            /* on the learning rates in cl/update.cl; */
#define ROUND_RATE 0.5      /* in the rounds */
#define SURPLUS 1.35        /* splats fitted for each that the budget holds */
#define POSITION_BITS 10    /* paper, section 3.3 */
#define FIT_SHARE 0.5       /* of the time, for the progress report */
#define LAMBDA 0.05         /* first price of a bit, in squared errors per bit of the file */
#define BUDGET_AIM 0.995    /* of the budget */
#define PRICE_GAIN 4.0      /* how strongly a file that is too large raises the price */
#define REPORT_INTERVAL 25  /* steps */

static const int steps_of_effort[GSCL_MAX_EFFORT + 1] = {120, 200, 300, 400, 500, 600, 1200, 2000, 3000, 5000};
static const int rounds_of_effort[GSCL_MAX_EFFORT + 1] = {1, 2, 3, 4, 4, 5, 6, 7, 8, 10};
static const int round_steps_of_effort[GSCL_MAX_EFFORT + 1] = {10, 15, 20, 25, 30, 30, 40, 60, 80, 100};

typedef struct trainer {
    gscl_encoder *encoder;
    gscl_fit fit;
    gscl_codebook codebook;
    int steps;
    size_t start, target;  /* splats */
    size_t bytes;          /* budget, or 0 */
    int words[GSCL_BOOKS]; /* most words of each book */
    double lambda;         /* price of a bit, in squared errors per bit of the budget */
    double error;          /* squared error of the free fit: what the price is measured in */
} trainer;

/* ---- How many words, bits and splats (P6) ---- */

/* Words grow with the square root of the file: more splats pay for finer books. */
static int words_for(double bits) {
    return (int)fmin(fmax(rint(16 * sqrt(bits / 2000)), 8), 512);
}

static int word_bits_for(double bits) {
    return bits < 30000 ? 6 : 7;
}

static double log2_factorial(double n) {
    return lgamma(n + 1) / log(2);
}

/* Splats that a file of `bits` holds, with books of k words. */
static double splats_for(double bits, int shape_words, int colour_words, int word_bits, int colour_dims) {
    double books = 200 + word_bits * (3.0 * shape_words + colour_dims * (double)colour_words) -
                   log2_factorial(shape_words) - log2_factorial(colour_words);
    double each = log2(shape_words) + log2(colour_words) - 0.7 + 2 * POSITION_BITS;
    double n = fmax((bits - books) / each, 1);
    for (int i = 0; i < 20; i++)
        n = fmax((bits - books) / (each - log2_factorial(n) / n), 1); /* the order saves log2 n! */
    return n;
}

/* ---- The free fit ---- */

typedef struct key {
    float size;
    size_t splat;
} key;

static int compare_keys(const void *a, const void *b) {
    const key *p = a, *q = b;
    if (p->size != q->size)
        return p->size < q->size ? 1 : -1;
    return p->splat < q->splat ? -1 : p->splat > q->splat;
}

/* The default order: large splats in the back.  Drops those that have faded away (P7: opacity below 0.001). */
static gscl_result sort_by_size(trainer *t) {
    size_t count = (size_t)t->fit.renderer.count, kept = 0;
    float *params = malloc((count + 1) * GSCL_PARAMS * sizeof(float));
    key *keys = malloc((count + 1) * sizeof *keys);
    size_t *order = malloc((count + 1) * sizeof *order);
    gscl_result result =
        params && keys && order ? gscl_fit_read(&t->fit, params) : gscl_fail_memory(t->encoder->context);
    for (size_t i = 0; i < count && result == GSCL_OK; i++) {
        const float *p = params + i * GSCL_PARAMS;
        if (p[GSCL_OPACITY] > -6.9f)
            keys[kept++] = (key){fmaxf(p[GSCL_LOG_S1], p[GSCL_LOG_S2]), i};
    }
    if (result == GSCL_OK && kept > 0) {
        qsort(keys, kept, sizeof *keys, compare_keys);
        for (size_t i = 0; i < kept; i++)
            order[i] = keys[i].splat;
        result = gscl_fit_reorder(&t->fit, order, kept);
    }
    free(params);
    free(keys);
    free(order);
    return result;
}

static double rate_at(double fraction) {
    return RATE * (fraction < 0.5 ? 1.0 : 0.1 + 0.9 * 0.5 * (1 + cos(3.14159265 * (fraction - 0.5) / 0.5)));
}

static int level_at(double fraction, int first_level) {
    return first_level + (fraction < QUARTER_UNTIL ? 2 : fraction < HALF_UNTIL ? 1 : 0);
}

static gscl_result grow_to(trainer *t, int round) {
    size_t want = t->start + (t->target - t->start) * (size_t)round / GROW_ROUNDS, have = (size_t)t->fit.renderer.count;
    if (want > have) {
        size_t pulled = (want - have) / 2;
        GSCL_TRY(gscl_density_densify(&t->fit, pulled));
        GSCL_TRY(gscl_density_grow(&t->fit, want - (size_t)t->fit.renderer.count, &t->encoder->random));
    }
    return sort_by_size(t);
}

static gscl_result report(trainer *t, double fraction) {
    gscl_encoder *e = t->encoder;
    if (!e->progress.callback)
        return GSCL_OK;
    e->progress.splats = (uint32_t)t->fit.renderer.count;
    return gscl_progress_report(e->context, &e->progress, fraction);
}

static gscl_result fit_freely(trainer *t, int last_step) {
    int round = 0;
    for (int step = 0; step < last_step; step++) {
        double fraction = (double)step / t->steps;
        int level = level_at(fraction, t->encoder->source.first_level);
        if (step == 0 || level != t->fit.level) {
            GSCL_TRY(gscl_fit_set_level(&t->fit, level));
            gscl_stage(t->encoder->context, gscl_fit_stage(&t->fit));
        }
        if (step == 0)
            GSCL_TRY(gscl_density_seed(&t->fit, t->start, &t->encoder->random));
        while (round < GROW_ROUNDS && fraction >= GROW_UNTIL * (round + 1) / GROW_ROUNDS)
            GSCL_TRY(grow_to(t, ++round));
        if (step == (int)(REPLENISH_AT * t->steps))
            GSCL_TRY(grow_to(t, GROW_ROUNDS));
        if (step % SORT_INTERVAL == 0)
            GSCL_TRY(sort_by_size(t));
        GSCL_TRY(gscl_fit_step(&t->fit, (float)rate_at(fraction)));
        if (step % REPORT_INTERVAL == 0)
            GSCL_TRY(report(t, FIT_SHARE * fraction));
        if ((step + 1) % gscl_trace_interval(t->steps) == 0)
            GSCL_TRY(gscl_trace_fit(t->encoder, &t->fit, step + 1));
    }
    GSCL_TRY(sort_by_size(t));
    return gscl_fit_set_level(&t->fit, t->encoder->source.first_level);
}

/* ---- Codebooks ---- */

static gscl_result cluster(trainer *t, bool warm) {
    GSCL_TRY(gscl_codebook_cluster(&t->codebook, t->words[0], t->words[1], warm, &t->encoder->random));
    return gscl_codebook_sort(&t->codebook, &t->encoder->coded);
}

/* P5: K-means while training, gradients straight through the quantisation. */
static gscl_result fit_through(trainer *t, int first_step) {
    for (int step = first_step; step < t->steps; step++) {
        if ((step - first_step) % CLUSTER_INTERVAL == 0)
            GSCL_TRY(cluster(t, step > first_step));
        GSCL_TRY(gscl_codebook_step_through(&t->codebook, (float)rate_at((double)step / t->steps)));
    }
    return cluster(t, t->steps > first_step);
}

static gscl_result write_size(trainer *t, size_t *size) {
    GSCL_TRY(gscl_codebook_pull(&t->codebook));
    GSCL_TRY(gscl_codebook_quantise(&t->codebook, &t->encoder->coded));
    return gscl_encoder_size(t->encoder, size);
}

/* One pass of choosing words at a price of `factor` times the current one. */
static gscl_result choose(trainer *t, double factor, size_t *size) {
    double error;
    GSCL_TRY(gscl_codebook_sort(&t->codebook, &t->encoder->coded));
    GSCL_TRY(gscl_codebook_project(&t->codebook));
    GSCL_TRY(gscl_fit_rendering_error(&t->fit, &error));
    GSCL_TRY(write_size(t, size));
    double bits = 8.0 * (double)(t->bytes ? t->bytes : *size);
    bool keep_all = t->bytes == 0 || *size < t->bytes;
    gscl_stage(t->encoder->context, GSCL_STAGE_CHOOSE_WORDS);
    GSCL_TRY(gscl_codebook_choose(&t->codebook, factor * t->lambda * t->error / bits, keep_all));
    GSCL_TRY(write_size(t, size));
    gscl_log(t->encoder->context, GSCL_LOG_DEBUG,
             "choose: %.2f dB before, then %d splats, %d shapes, %d colours, %zu bytes, price %.2f",
             -10 * log10(error / ((double)gscl_renderer_plane(&t->fit.renderer) * t->fit.renderer.channels)),
             (int)t->fit.renderer.count, t->codebook.books[0].count, t->codebook.books[1].count, *size,
             factor * t->lambda);
    return gscl_trace_coded_image(t->encoder, &t->fit, t->steps);
}

/* Learns words and positions for the picture. */
static gscl_result learn(trainer *t, double rate, int steps) {
    gscl_stage(t->encoder->context, GSCL_STAGE_LEARN_WORDS);
    GSCL_TRY(gscl_codebook_rest(&t->codebook));
    for (int step = 0; step < steps; step++) {
        if (step % SORT_INTERVAL == 0)
            GSCL_TRY(gscl_codebook_sort(&t->codebook, &t->encoder->coded));
        GSCL_TRY(gscl_codebook_step(&t->codebook, (float)(rate * (1 - 0.7 * step / steps))));
    }
    return GSCL_OK;
}

/* The size that round `round` of `rounds` should leave: from `first` gently down to the budget, since splats that were
 * dropped in haste do not come back. */
static double goal(const trainer *t, double first, int round, int rounds) {
    double left = 1 - fmin((double)round / rounds, 1);
    return (double)t->bytes * BUDGET_AIM + fmax(first - (double)t->bytes, 0) * left * left;
}

static gscl_result run_rounds(trainer *t) {
    t->fit.renderer.options.loss =
        GSCL_LOSS_KIND_L2; /* rate and distortion are weighed in squared error from here on */
    int effort = t->encoder->settings.effort, rounds = rounds_of_effort[effort];
    size_t size, before;
    GSCL_TRY(write_size(t, &size));
    double first = (double)size;
    for (int round = 0; round < rounds; round++) {
        double done = (double)round / rounds;
        before = size;
        GSCL_TRY(choose(t, 1, &size));
        if (t->bytes) {
            double next = (double)size * fmin((double)size / (double)before, 1);
            t->lambda *= fmin(fmax(pow(next / goal(t, first, round + 1, rounds), PRICE_GAIN), 0.4), 2.5);
        }
        GSCL_TRY(learn(t, ROUND_RATE * (1 - 0.8 * done), round_steps_of_effort[effort]));
        GSCL_TRY(report(t, FIT_SHARE + (1 - FIT_SHARE) * done));
    }
    return GSCL_OK;
}

/* Takes the front-most splats of the smallest shape away, and the words that only they used, until the file fits: a
 * last resort. */
static gscl_result trim(trainer *t, size_t size) {
    gsf_header *header = &t->encoder->coded.file.header;
    while (size > t->bytes && header->splat_count > 0) {
        size_t excess = (size - t->bytes) / 6 + 1;
        header->splat_count -= (uint32_t)(excess < header->splat_count ? excess : header->splat_count);
        gscl_codebook_drop_unused(&t->encoder->coded.file);
        GSCL_TRY(gscl_encoder_size(t->encoder, &size));
    }
    return GSCL_OK;
}

/* Chooses at rising prices until the file all but fits, learns once more for the words that are left, and trims. */
static gscl_result meet_budget(trainer *t) {
    size_t size;
    GSCL_TRY(choose(t, 1, &size));
    double factor = 1;
    for (int i = 0; t->bytes && size > t->bytes + t->bytes / 50 + 8 && i < 16; i++) {
        factor *= 1.02 + fmin(4 * ((double)size / (double)t->bytes - 1), 0.5);
        GSCL_TRY(choose(t, factor, &size));
    }
    GSCL_TRY(learn(t, 0.4 * ROUND_RATE, round_steps_of_effort[t->encoder->settings.effort]));
    GSCL_TRY(gscl_codebook_sort(&t->codebook, &t->encoder->coded));
    GSCL_TRY(write_size(t, &size));
    return t->bytes ? trim(t, size) : GSCL_OK;
}

static gscl_result train(trainer *t) {
    gscl_encoder *e = t->encoder;
    gscl_kernel_options options = gscl_coded_image_options(&e->coded.file.header);
    options.loss = gscl_loss_kind(e->settings.loss);
    int through = (int)(t->steps * THROUGH_FROM), bits = word_bits_for(8.0 * (double)t->bytes);
    GSCL_TRY(gscl_fit_create(&t->fit, e->context, &options, e->image->width, e->image->height, e->source.first_level,
                             e->source.planes));
    for (int k = 0; k < t->fit.renderer.channels; k++)
        e->coded.file.background[k] = gscl_quantise_background(&e->coded.file.header, t->fit.background[k]);
    GSCL_TRY(fit_freely(t, through));
    GSCL_TRY(gscl_fit_rendering_error(&t->fit, &t->error));
    GSCL_TRY(gscl_codebook_create(&t->codebook, &t->fit, POSITION_BITS, bits, bits));
    gscl_log(e->context, GSCL_LOG_DEBUG, "free fit: %d of %zu splats", (int)t->fit.renderer.count, t->target);
    gscl_stage(e->context, GSCL_STAGE_FIT_CODEBOOKS);
    GSCL_TRY(fit_through(t, through));
    GSCL_TRY(run_rounds(t));
    return meet_budget(t);
}

gscl_result gscl_encode_codebook(gscl_encoder *e, size_t bytes, size_t splats) {
    trainer t = {
        .encoder = e, .steps = steps_of_effort[e->settings.effort], .bytes = bytes, .target = splats, .lambda = LAMBDA};
    double bits = bytes ? 8.0 * (double)bytes : 26.0 * (double)splats;
    int words = e->settings.codebook_size ? (int)e->settings.codebook_size : words_for(bits);
    t.words[GSCL_BOOK_SHAPE] = t.words[GSCL_BOOK_COLOUR] = words;
    int dims = (int)gsf_channel_count(&e->coded.file.header) + 1;
    if (bytes)
        t.target = (size_t)fmin(SURPLUS * splats_for(bits, words, words, word_bits_for(bits), dims),
                                (double)gscl_max_splats(e, bytes)) +
                   1;
    t.start = (size_t)ceil((double)t.target * START_SHARE);
    gscl_result result = train(&t);
    gscl_codebook_free(&t.codebook);
    gscl_fit_free(&t.fit);
    return result;
}
