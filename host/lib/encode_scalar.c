/* The default profile: a pyramid fit with scalar quantisation in the loop. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "constants.h"
#include "density.h"
#include "encoder.h"
#include "quantise.h"
#include "refine.h"

#define START_SHARE 0.3      /* of the splats are there at the first step */
#define GROW_ROUNDS 12       /* in which the others are added */
#define GROW_UNTIL 0.48      /* of the steps; then the number of splats stays */
#define MEASURE_ROUND 8      /* round after which real bits per splat replace the estimate */
#define QUANTISE_FROM 0.25   /* of the steps: from then on the fit looks through the quantiser */
#define QUARTER_UNTIL 0.5    /* of the steps at a quarter of the size, */
#define HALF_UNTIL 0.85      /* then at half the size, the rest at full size */
#define RATE 2.0             /* on the learning rates in cl/update.cl */
#define BITS_PER_SPLAT 34.0  /* first estimate */
#define REPORT_INTERVAL 25   /* steps */
#define SORT_INTERVAL 25     /* steps; blend alpha */
#define SURPLUS 1.3          /* where refinement follows */
#define FIT_SHARE 0.75       /* of the time, for the progress report */
#define PRESSURE_GAIN 2.0    /* how strongly a file that is too large raises the price of a bit */
#define BUDGET_AIM 0.99      /* of the budget */
#define REGROW_BELOW 0.98    /* of the budget: then there is room for more splats */
#define REGROW_SHARE 1.3     /* refinement drops some of them again */
#define REGROW_STEPS_PART 12 /* part of the steps that a regrowth takes */
#define MAX_REGROWS 6
#define FIRST_PRESSURE 0.5 /* what is dropped too early does not come back */
#define LEAST_PRESSURE 0.1
#define MOST_PRESSURE 20.0

typedef struct schedule {
    gscl_encoder *encoder;
    gscl_fit fit;
    int steps;
    size_t start, target; /* splats */
    size_t bytes;         /* budget, or 0 */
    size_t most;          /* splats that the image can use */
    double surplus;       /* splats fitted for each that the budget holds; refinement drops the others */
    double pressure;      /* price of a bit in the next pass of refinement, see gscl_refine_pass */
    float *params;
    size_t capacity;
} schedule;

static const int steps_of_effort[GSCL_MAX_EFFORT + 1] = {150, 250, 400, 600, 800, 1000, 1600, 2500, 4000, 7000};
static const int passes_of_effort[GSCL_MAX_EFFORT + 1] = {4, 4, 5, 6, 8, 10, 12, 16, 20, 24};

/* cosine decay over the second half */
static double rate_at(double fraction) {
    return RATE * (fraction < 0.5 ? 1.0 : 0.02 + 0.98 * 0.5 * (1 + cos(3.14159265 * (fraction - 0.5) / 0.5)));
}

static int level_at(double fraction, int first_level) {
    return first_level + (fraction < QUARTER_UNTIL ? 2 : fraction < HALF_UNTIL ? 1 : 0);
}

static gscl_result reserve_params(schedule *s, size_t count) {
    if (count <= s->capacity)
        return GSCL_OK;
    float *grown = realloc(s->params, count * GSCL_PARAMS * sizeof(float));
    if (!grown)
        return gscl_fail(s->encoder->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
    s->params = grown;
    s->capacity = count;
    return GSCL_OK;
}

/* Puts the picture's splats, as they are coded, into the fit. */
static gscl_result load_picture(schedule *s) {
    float background[4];
    size_t count = s->encoder->picture.file.header.splat_count;
    GSCL_TRY(reserve_params(s, count));
    gscl_picture_params(&s->encoder->picture, s->params, background);
    return gscl_fit_replace(&s->fit, s->params, count);
}

/* Reads the splats and turns them into codes. */
static gscl_result quantise_all(schedule *s) {
    gscl_picture *picture = &s->encoder->picture;
    size_t count = (size_t)s->fit.renderer.count;
    GSCL_TRY(reserve_params(s, count));
    GSCL_TRY(gscl_fit_read(&s->fit, s->params));
    picture->file.header.splat_count = (uint32_t)count;
    GSCL_TRY(gscl_picture_reserve(picture, count));
    for (size_t i = 0; i < count; i++)
        gscl_quantise(&picture->file, s->params + i * GSCL_PARAMS, &picture->file.splats[i]);
    return GSCL_OK;
}

/* How many splats the budget allows, from the bits that the splats of this moment take. */
static gscl_result measure_target(schedule *s) {
    size_t size;
    GSCL_TRY(quantise_all(s));
    GSCL_TRY(gscl_picture_size(&s->encoder->picture, &size));
    double count = s->fit.renderer.count, side = 20;
    double bits = ((double)size - side) / count;
    double target = ((double)s->bytes - side) / bits * s->surplus;
    s->target = (size_t)fmin(fmax(target, 1), (double)s->most);
    return GSCL_OK;
}

/* `alpha` depends on the order: fits in the order in which the file will store the splats. */
static gscl_result sort_for_alpha(schedule *s) {
    size_t count = (size_t)s->fit.renderer.count;
    GSCL_TRY(quantise_all(s));
    size_t *order = malloc((count + 1) * sizeof *order);
    gscl_result result = order ? gscl_picture_sort(&s->encoder->picture, order) : GSCL_ERROR_OUT_OF_MEMORY;
    if (result == GSCL_OK)
        result = gscl_fit_reorder(&s->fit, order, count);
    free(order);
    return result;
}

static gscl_result grow_round(schedule *s, int round) {
    if (s->bytes && round == MEASURE_ROUND)
        GSCL_TRY(measure_target(s));
    size_t want =
        s->start + (size_t)((double)(s->target - (s->target < s->start ? s->target : s->start)) * round / GROW_ROUNDS);
    size_t have = (size_t)s->fit.renderer.count;
    return want > have ? gscl_density_grow(&s->fit, want - have, &s->encoder->random) : GSCL_OK;
}

static gscl_result report(schedule *s, int step) {
    gscl_progress_state *progress = &s->encoder->progress;
    if (!progress->callback || step % REPORT_INTERVAL != 0)
        return GSCL_OK;
    double loss;
    GSCL_TRY(gscl_fit_loss(&s->fit, &loss));
    progress->psnr = s->encoder->settings.loss == GSCL_LOSS_L2 && loss > 0 ? -10 * log10(loss) : 0;
    progress->splats = (uint32_t)s->fit.renderer.count;
    return gscl_progress_report(s->encoder->context, progress, FIT_SHARE * step / s->steps);
}

/* From now on the fit looks through the quantiser. */
static gscl_result set_quantiser(schedule *s) {
    float steps[GSCL_STEP_COUNT];
    gscl_steps_to_floats(&s->encoder->picture.file.steps, steps);
    GSCL_TRY(gscl_renderer_set_steps(&s->fit.renderer, steps));
    return gscl_renderer_project(&s->fit.renderer);
}

static gscl_result run_steps(schedule *s) {
    int round = 0;
    bool quantising = false;
    for (int step = 0; step < s->steps; step++) {
        double fraction = (double)step / s->steps;
        int level = level_at(fraction, s->encoder->first_level);
        if (step == 0 || level != s->fit.level)
            GSCL_TRY(gscl_fit_set_level(&s->fit, level));
        if (step == 0)
            GSCL_TRY(gscl_density_seed(&s->fit, s->start, &s->encoder->random));
        if (!quantising && fraction >= QUANTISE_FROM) {
            quantising = true;
            GSCL_TRY(set_quantiser(s));
        }
        while (round < GROW_ROUNDS && fraction >= GROW_UNTIL * (round + 1) / GROW_ROUNDS)
            GSCL_TRY(grow_round(s, ++round));
        if (s->encoder->settings.blend == GSCL_BLEND_ALPHA && step % SORT_INTERVAL == 0)
            GSCL_TRY(sort_for_alpha(s));
        GSCL_TRY(gscl_fit_step(&s->fit, (float)rate_at(fraction)));
        GSCL_TRY(report(s, step));
    }
    return GSCL_OK;
}

static void drop_smallest(gsf_picture *file) {
    size_t least = 0, count = file->header.splat_count;
    for (size_t i = 1; i < count; i++)
        if (2 * file->splats[i].minor + file->splats[i].aspect <
            2 * file->splats[least].minor + file->splats[least].aspect)
            least = i;
    memmove(&file->splats[least], &file->splats[least + 1], (count - 1 - least) * sizeof file->splats[0]);
    file->header.splat_count--;
}

/* Drops splats, the smallest first, until the file fits. */
static gscl_result trim(schedule *s) {
    gscl_picture *picture = &s->encoder->picture;
    gsf_picture *file = &picture->file;
    size_t size;
    GSCL_TRY(gscl_picture_size(picture, &size));
    while (size > s->bytes && file->header.splat_count > 0) {
        for (size_t excess = (size - s->bytes) / 5 + 1; excess > 0 && file->header.splat_count > 0; excess--)
            drop_smallest(file);
        GSCL_TRY(gscl_picture_size(picture, &size));
    }
    return GSCL_OK;
}

/* One pass, and what it leaves. */
static gscl_result refine_once(schedule *s, size_t *size) {
    gscl_picture *picture = &s->encoder->picture;
    GSCL_TRY(gscl_refine_pass(&s->fit, picture, s->pressure, s->bytes == 0));
    GSCL_TRY(gscl_picture_size(picture, size));
    gscl_log(s->encoder->context, GSCL_LOG_DEBUG, "pass: %u splats, %zu bytes, pressure %.2f",
             picture->file.header.splat_count, *size, s->pressure);
    s->encoder->progress.splats = picture->file.header.splat_count;
    return GSCL_OK;
}

/* The size that pass `pass` of `passes` should leave: from `first`, the size that the first pass left, gently down to
 * the budget two passes before the end, since splats that were dropped in haste do not come back. */
static double goal(const schedule *s, double first, int pass, int passes) {
    double left = fmax(1 - (double)pass / fmax(passes - 2, 1), 0);
    return (double)s->bytes * BUDGET_AIM + fmax(first - (double)s->bytes, 0) * pow(left, 1.5);
}

/* Passes over the codes, with a pressure that takes the file down to its budget; more than `passes` when it is still
 * too large then. */
static gscl_result refine(schedule *s, int passes, size_t *size) {
    gscl_encoder *e = s->encoder;
    double first = 0;
    GSCL_TRY(gscl_picture_size(&e->picture, size));
    for (int pass = 0; pass < passes || (s->bytes && *size > s->bytes && pass < 2 * passes); pass++) {
        double before = (double)*size;
        GSCL_TRY(refine_once(s, size));
        GSCL_TRY(gscl_progress_report(e->context, &e->progress,
                                      FIT_SHARE + (1 - FIT_SHARE) * fmin((pass + 1.0) / passes, 1)));
        if (!s->bytes)
            continue;
        if (pass == 0)
            first = before = (double)*size;
        /* At this pressure the file would go on shrinking: what counts is where the next pass would take it. */
        double next = (double)*size * (double)*size / before;
        double excess = next / goal(s, first, pass + 1, passes);
        s->pressure = fmin(fmax(s->pressure * pow(excess, PRESSURE_GAIN), LEAST_PRESSURE), MOST_PRESSURE);
    }
    return GSCL_OK;
}

/* Adds splats where the picture is worst, for the bytes that are left, and fits all of them for a while. */
static gscl_result regrow(schedule *s, size_t size) {
    size_t count = s->encoder->picture.file.header.splat_count;
    size_t more = (size_t)(REGROW_SHARE * (double)(s->bytes - size) / (double)size * (double)count) + 1;
    int steps = s->steps / REGROW_STEPS_PART + 1;
    if (count + more > s->most)
        more = s->most > count ? s->most - count : 0;
    GSCL_TRY(load_picture(s));
    GSCL_TRY(set_quantiser(s));
    GSCL_TRY(gscl_density_grow(&s->fit, more, &s->encoder->random));
    for (int step = 0; step < steps; step++)
        GSCL_TRY(gscl_fit_step(&s->fit, (float)rate_at(0.5 + 0.5 * (step + 0.5) / steps)));
    return quantise_all(s);
}

/* Refines the codes, and adds splats as long as the budget holds more of them. */
static gscl_result refine_to_budget(schedule *s) {
    size_t size;
    int passes = passes_of_effort[s->encoder->settings.effort];
    GSCL_TRY(refine(s, passes, &size));
    for (int i = 0; s->bytes && size < (size_t)(REGROW_BELOW * (double)s->bytes) && i < MAX_REGROWS; i++) {
        if (s->encoder->picture.file.header.splat_count >= s->most)
            break;
        GSCL_TRY(regrow(s, size));
        GSCL_TRY(refine(s, passes / 2 + 1, &size));
    }
    return GSCL_OK;
}

/* The order of `alpha` makes the change of one splat reach all others under it: not refined. */
static bool can_refine(const gscl_encoder *e) {
    return e->settings.blend != GSCL_BLEND_ALPHA;
}

static void default_steps(gsf_steps *steps) {
    *steps = (gsf_steps){.scale = 6, .position = 8, .angle = 4, .luma = 8, .chroma = 4, .alpha = 4, .opacity = 3};
}

static gscl_result fit_and_quantise(schedule *s) {
    gscl_encoder *e = s->encoder;
    gscl_kernel_options options = gscl_picture_options(&e->picture.file.header);
    options.loss = gscl_loss_kind(e->settings.loss);
    GSCL_TRY(
        gscl_fit_create(&s->fit, e->context, &options, e->image->width, e->image->height, e->first_level, e->planes));
    for (int k = 0; k < s->fit.renderer.channels; k++)
        e->picture.file.background[k] = gscl_quantise_background(&e->picture.file.header, s->fit.background[k]);
    GSCL_TRY(run_steps(s));
    GSCL_TRY(quantise_all(s));
    if (can_refine(e))
        GSCL_TRY(refine_to_budget(s));
    return s->bytes ? trim(s) : GSCL_OK;
}

gscl_result gscl_encode_scalar(gscl_encoder *e, size_t bytes, size_t splats) {
    schedule s = {.encoder = e,
                  .steps = steps_of_effort[e->settings.effort],
                  .bytes = bytes,
                  .target = splats,
                  .pressure = bytes ? FIRST_PRESSURE : 1};
    default_steps(&e->picture.file.steps);
    if (bytes)
        s.target = bytes > 24 ? (size_t)((double)(bytes - 20) * 8 / BITS_PER_SPLAT) + 1 : 0;
    s.surplus = can_refine(e) ? SURPLUS : 1.0;
    s.most = gscl_most_splats(e, bytes);
    if (s.target > s.most)
        s.target = s.most;
    s.start = (size_t)ceil((double)s.target * START_SHARE);
    gscl_result result = fit_and_quantise(&s);
    gscl_fit_free(&s.fit);
    free(s.params);
    return result;
}
