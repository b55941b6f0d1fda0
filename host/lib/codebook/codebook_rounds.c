#include "codebook/codebook_rounds.h"

#include <math.h>

#include "codebook/codebook_fit.h"
#include "codebook/codebook_order.h"
#include "codebook/codebook_quantise.h"
#include "codebook/codebook_step.h"
#include "codebook/tunables.h"
#include "runtime/elementary.h"
#include "runtime/timing.h"
#include "session/encode_trace.h"

/* Quantises into the encoder's coded image.  *size: of its file. */
static gscl_result quantise_and_size(gscl_codebook_state *s, size_t *size) {
    GSCL_TRY(gscl_codebook_read_back(&s->codebook));
    GSCL_TRY(gscl_codebook_quantise(&s->codebook, &s->encoder->coded));
    GSCL_TRY(gscl_coded_image_sort(&s->encoder->coded, NULL));
    return gscl_file_size(s->encoder->context, &s->encoder->coded, size);
}

static void log_pass(const gscl_codebook_state *s, double error_before, double lambda_scale, size_t size) {
    const gscl_renderer *r = &s->fit.renderer;
    const gscl_book *books = s->codebook.books;
    gscl_log(s->encoder->context, GSCL_LOG_DEBUG,
             "RDO pass: %.2f dB before, then %d splats, %d shapes, %d colours, %zu bytes, lambda scale %.2f",
             -10 * gscl_log10(error_before / ((double)gscl_renderer_plane(r) * r->channels)), (int)r->count,
             books[GSCL_BOOK_SHAPE].count, books[GSCL_BOOK_COLOUR].count, size, lambda_scale);
}

/* One RDO pass with a lambda of `factor` times the current one.  *size: of the file after the pass. */
static gscl_result run_rdo_pass(gscl_codebook_state *s, double factor, size_t *size) {
    const size_t budget = s->plan.bytes;
    double error;
    GSCL_TRY(gscl_codebook_sort(&s->codebook, &s->encoder->coded));
    GSCL_TRY(gscl_codebook_project(&s->codebook));
    GSCL_TRY(gscl_fit_rendering_error(&s->fit, &error));
    GSCL_TRY(quantise_and_size(s, size));
    const double bits = 8.0 * (double)(budget ? budget : *size);
    const bool keep_all = budget == 0 || *size < budget;
    gscl_stage(s->encoder->context, GSCL_STAGE_RDO);
    GSCL_TRY(gscl_codebook_rdo_run(&s->rdo, factor * s->lambda_scale * s->fit_error / bits, keep_all));
    GSCL_TRY(quantise_and_size(s, size));
    log_pass(s, error, factor * s->lambda_scale, *size);
    return gscl_trace_coded_image(s->encoder, &s->fit, &s->encoder->coded, s->plan.steps);
}

/* Learns words and positions; the learning rate falls from `rate`. */
static gscl_result learn_words(gscl_codebook_state *s, double rate) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const int steps = s->plan.round_steps;
    gscl_stage(s->encoder->context, GSCL_STAGE_LEARN_WORDS);
    GSCL_TRY(gscl_codebook_restart_optimiser(&s->codebook));
    for (int step = 0; step < steps; step++) {
        if (step % t->sort_interval == 0)
            GSCL_TRY(gscl_codebook_sort(&s->codebook, &s->encoder->coded));
        GSCL_TRY(gscl_codebook_step(&s->codebook, (float)(rate * (1 - t->step_rate_fall * step / steps))));
    }
    return GSCL_OK;
}

/* The size that round `round` should leave.  It falls slowly from `first` to the budget, because splats that were
 * dropped too early do not come back. */
static double target_size(const gscl_codebook_plan *plan, double first, int round) {
    const double budget = (double)plan->bytes, left = 1 - fmin((double)round / plan->rounds, 1);
    return budget * gscl_codebook_tunables.target_share + fmax(first - budget, 0) * left * left;
}

/* Raises lambda where the size, continued at the rate of the last pass, is above the target, and lowers it below. */
static void update_lambda(gscl_codebook_state *s, size_t before, size_t size, double target) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const double next = (double)size * fmin((double)size / (double)before, 1);
    s->lambda_scale *= fmin(fmax(gscl_pow(next / target, t->lambda_gain), t->min_lambda_change), t->max_lambda_change);
}

gscl_result gscl_codebook_run_rounds(gscl_codebook_state *s) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const int rounds = s->plan.rounds;
    size_t size;
    gscl_kernel_options options = s->fit.renderer.options;
    options.loss = GSCL_LOSS_KIND_L2; /* lambda is in squared error */
    gscl_renderer_set_options(&s->fit.renderer, &options);
    GSCL_TRY(gscl_codebook_rdo_create(&s->rdo, &s->codebook));
    GSCL_TRY(quantise_and_size(s, &size));
    const double first = (double)size;
    for (int round = 0; round < rounds; round++) {
        const double done = (double)round / rounds;
        const size_t before = size;
        GSCL_TRY(run_rdo_pass(s, 1, &size));
        if (s->plan.bytes)
            update_lambda(s, before, size, target_size(&s->plan, first, round + 1));
        GSCL_TRY(learn_words(s, t->round_rate * (1 - t->round_rate_fall * done)));
        GSCL_TRY(gscl_codebook_report_progress(s, GSCL_CODEBOOK_FIT_SHARE + (1 - GSCL_CODEBOOK_FIT_SHARE) * done));
    }
    return GSCL_OK;
}

/* Cuts off the front-most splats of the smallest shape, and the words that only they used, until the file fits. */
static gscl_result cut_off_splats(gscl_codebook_state *s, size_t size) {
    gsf_coded_image *file = &s->encoder->coded.file;
    const size_t budget = s->plan.bytes;
    while (size > budget && file->header.splat_count > 0) {
        const size_t excess = (size - budget) / gscl_codebook_tunables.cut_bytes + 1;
        file->header.splat_count -= (uint32_t)(excess < file->header.splat_count ? excess : file->header.splat_count);
        gscl_coded_codebooks_drop_unused(file);
        GSCL_TRY(gscl_file_size(s->encoder->context, &s->encoder->coded, &size));
    }
    return GSCL_OK;
}

gscl_result gscl_codebook_meet_budget(gscl_codebook_state *s) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const size_t budget = s->plan.bytes, all_but_fits = budget + budget / t->slack_divisor + t->slack_bytes;
    size_t size;
    double factor = 1;
    GSCL_TRY(run_rdo_pass(s, 1, &size));
    for (int i = 0; budget && size > all_but_fits && i < t->max_budget_passes; i++) {
        factor *= t->min_pass_growth + fmin(t->pass_gain * ((double)size / (double)budget - 1), t->max_pass_gain);
        GSCL_TRY(run_rdo_pass(s, factor, &size));
    }
    GSCL_TRY(learn_words(s, t->last_rate * t->round_rate));
    GSCL_TRY(gscl_codebook_sort(&s->codebook, &s->encoder->coded));
    GSCL_TRY(quantise_and_size(s, &size));
    if (budget)
        GSCL_TRY(cut_off_splats(s, size));
    return gscl_trace_coded_image(s->encoder, &s->fit, &s->encoder->coded, s->plan.steps);
}
