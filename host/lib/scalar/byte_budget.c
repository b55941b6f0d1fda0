/* From a fit that is a little too large to a file that just fits its budget. */
#include "scalar/byte_budget.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fit/density.h"
#include "session/effects.h"
#include "scalar/scalar_rdo.h"
#include "session/encode_trace.h"
#include "runtime/timing.h"

#define PRESSURE_GAIN 2.0    /* how strongly a file that is too large raises the price of a bit */
#define BUDGET_AIM 0.99      /* of the budget */
#define SCAN_INTERVAL 3      /* passes from one scan for textures to the next */
#define FEW_TEXTURES 0.01    /* of the splats */
#define REGROW_BELOW 0.97    /* of the budget: then there is room for more splats */
#define REGROW_STEPS_PART 12 /* part of the steps that a regrowth takes */
#define MAX_REGROW_STEPS 80
#define MAX_REGROWS 4
#define LANDING_GAIN 4.0 /* as PRESSURE_GAIN, where few passes are left */
#define FULL 0.985       /* of the budget: no more is asked for */
#define MAX_LANDINGS 12
#define MAX_FILLS 4
#define LEAST_PRESSURE 0.02
#define MOST_PRESSURE 1e4

typedef gscl_scalar_state schedule;

/* One pass, and what it leaves. */
static gscl_result refine_once(schedule *s, bool scan_textures, size_t *size) {
    gscl_coded_image *picture = &s->encoder->coded;
    gscl_scalar_rdo_settings settings = {
        .pressure = s->pressure, .keep_all = s->keep_all, .scan_textures = scan_textures};
    GSCL_TRY(gscl_scalar_rdo_pass(&s->fit, picture, &settings));
    GSCL_TRY(gscl_coded_image_sort(&s->encoder->coded, NULL));
    GSCL_TRY(gscl_encoder_size(s->encoder, size));
    gscl_log(s->encoder->context, GSCL_LOG_DEBUG, "%.2f s, pass: %u splats, %zu bytes, pressure %.2f%s",
             gscl_now() - s->encoder->progress.start_s, picture->file.header.splat_count, *size, s->pressure,
             scan_textures ? ", scan" : "");
    s->encoder->progress.splats = picture->file.header.splat_count;
    s->passes_done++;
    GSCL_TRY(gscl_trace_coded_image(s->encoder, &s->fit, s->steps));
    return gscl_progress_report(s->encoder->context, &s->encoder->progress,
                                GSCL_SCALAR_FIT_SHARE +
                                    (1 - GSCL_SCALAR_FIT_SHARE) * fmin((double)s->passes_done / s->passes, 1));
}

/* Fits all splats for a while, `more` of them new where the picture is worst. */
static gscl_result refit(schedule *s, size_t more, int steps) {
    gscl_kernel_options options = s->fit.renderer.options;
    options.texture = s->encoder->coded.file.header.has_texture;
    gscl_renderer_set_options(&s->fit.renderer, GSCL_PROGRAM_FIT, &options);
    gscl_stage(s->encoder->context, GSCL_STAGE_REFIT);
    GSCL_TRY(gscl_scalar_load(s));
    GSCL_TRY(gscl_scalar_set_quantiser(s));
    GSCL_TRY(gscl_density_grow(&s->fit, more, &s->encoder->random));
    for (int step = 0; step < steps; step++)
        GSCL_TRY(gscl_fit_step(&s->fit, (float)gscl_scalar_learning_rate(0.5 + 0.5 * (step + 0.5) / steps)));
    return gscl_scalar_quantise(s);
}

/* Splats for the bytes that are left. */
static gscl_result regrow(schedule *s, size_t size) {
    size_t count = s->encoder->coded.file.header.splat_count;
    size_t wanted = (size_t)(s->surplus * (double)s->bytes / (double)size * (double)count) + 1;
    wanted = wanted > s->most ? s->most : wanted;
    int steps = s->steps / REGROW_STEPS_PART + 1;
    return refit(s, wanted > count ? wanted - count : 0, steps < MAX_REGROW_STEPS ? steps : MAX_REGROW_STEPS);
}

/* The first pass, without textures; splats are added as long as the budget clearly holds more of them. */
static gscl_result refine_plain(schedule *s, size_t *size) {
    for (int regrows = 0;; regrows++) {
        GSCL_TRY(refine_once(s, false, size));
        bool full = s->encoder->coded.file.header.splat_count >= s->most;
        if (s->bytes == 0 || full || regrows == MAX_REGROWS || (double)*size >= REGROW_BELOW * (double)s->bytes)
            return GSCL_OK;
        GSCL_TRY(regrow(s, *size));
    }
}

/* The pressure that takes the next pass to `goal` bytes, from the sizes before and after the last one. */
static void steer(schedule *s, double before, double size, double goal, double gain) {
    /* At this pressure the file would go on shrinking: what counts is where the next pass would take it. */
    double next = size < before ? size * size / before : size;
    s->pressure = fmin(fmax(s->pressure * pow(next / goal, gain), LEAST_PRESSURE), MOST_PRESSURE);
}

/* After the first scan: where hardly a splat took a wave, the others are not asked again. */
static void keep_textures(schedule *s) {
    const gsf_coded_image *file = &s->encoder->coded.file;
    const gscl_encode_settings *settings = &s->encoder->settings;
    uint32_t textured = 0;
    for (uint32_t i = 0; i < file->header.splat_count; i++)
        textured += file->splats[i].texture.amplitude > 0;
    if (gscl_effect_is_open(settings, GSCL_EFFECT_TEXTURE) && textured < FEW_TEXTURES * file->header.splat_count)
        s->textures = false;
}

/* Passes that take the file gently down towards its budget: splats that are dropped in haste do not come back. */
static gscl_result refine_down(schedule *s, size_t *size) {
    double budget = (double)s->bytes * BUDGET_AIM, excess = 0;
    for (int pass = 0; pass < s->passes; pass++) {
        double before = (double)*size, left = 1 - (pass + 2.0) / s->passes;
        GSCL_TRY(refine_once(s, s->textures && pass % SCAN_INTERVAL == 0, size));
        if (pass == 0)
            keep_textures(s);
        if (s->bytes == 0)
            continue;
        if (pass == 0)
            excess = fmax((double)*size - budget, 0);
        steer(s, before, (double)*size, budget + excess * pow(fmax(left, 0), 1.5), PRESSURE_GAIN);
    }
    return GSCL_OK;
}

/* Passes until the file just fits: one that shrinks it too far is taken back and done again at a lower pressure. */
static gscl_result land(schedule *s, size_t *size) {
    gsf_coded_image *file = &s->encoder->coded.file;
    gsf_splat *kept = malloc((file->header.splat_count + 1) * sizeof *kept);
    if (!kept)
        return gscl_fail_memory(s->encoder->context);
    gscl_result result = GSCL_OK;
    for (int pass = 0; pass < MAX_LANDINGS && result == GSCL_OK; pass++) {
        if (*size <= s->bytes)
            break;
        uint32_t count = file->header.splat_count;
        size_t before = *size;
        memcpy(kept, file->splats, count * sizeof *kept);
        result = refine_once(s, false, size);
        if (*size > s->bytes) {
            steer(s, (double)before, (double)*size, (double)s->bytes * BUDGET_AIM, LANDING_GAIN);
        } else if ((double)*size < (pass < MAX_LANDINGS - 1 ? FULL : REGROW_BELOW) * (double)s->bytes) {
            s->pressure *= 0.7;
            memcpy(file->splats, kept, count * sizeof *kept);
            file->header.splat_count = count;
            *size = before;
        }
    }
    free(kept);
    return result;
}

/* Uses bytes that are left: a few for finer codes and more textures, many for more splats. */
static gscl_result fill(schedule *s, size_t *size) {
    for (int pass = 0; pass < MAX_FILLS && (double)*size < FULL * (double)s->bytes; pass++) {
        bool most = s->encoder->coded.file.header.splat_count >= s->most;
        s->keep_all = true; /* those just added would be the first to go */
        if (!most && (double)*size < REGROW_BELOW * (double)s->bytes) {
            s->pressure = fmin(s->pressure, 1);
            s->surplus = 1;
            GSCL_TRY(regrow(s, *size));
        } else {
            s->pressure = fmax(s->pressure * 0.5, LEAST_PRESSURE);
        }
        GSCL_TRY(refine_once(s, s->textures, size));
    }
    s->keep_all = false;
    return GSCL_OK;
}

static void drop_unused_effects(gscl_encoder *e) {
    gsf_coded_image *file = &e->coded.file;
    bool textured = false;
    for (uint32_t i = 0; i < file->header.splat_count; i++)
        textured = textured || file->splats[i].texture.amplitude > 0;
    file->header.has_texture = textured;
    if (gscl_effect_is_open(&e->settings, GSCL_EFFECT_TEXTURE))
        gscl_effect_decide(e, GSCL_EFFECT_TEXTURE, GSCL_EFFECT_PASSES, textured, NAN);
}

gscl_result gscl_scalar_refine(schedule *s) {
    gsf_coded_image *file = &s->encoder->coded.file;
    size_t size;
    GSCL_TRY(refine_plain(s, &size));
    file->header.has_texture = s->textures;
    GSCL_TRY(refine_down(s, &size));
    if (s->bytes > 0) {
        GSCL_TRY(fill(s, &size));
        GSCL_TRY(land(s, &size));
    }
    drop_unused_effects(s->encoder);
    return GSCL_OK;
}

static void drop_smallest(gsf_coded_image *file) {
    size_t least = 0, count = file->header.splat_count;
    for (size_t i = 1; i < count; i++)
        if (2 * file->splats[i].minor + file->splats[i].aspect <
            2 * file->splats[least].minor + file->splats[least].aspect)
            least = i;
    memmove(&file->splats[least], &file->splats[least + 1], (count - 1 - least) * sizeof file->splats[0]);
    file->header.splat_count--;
}

gscl_result gscl_scalar_trim(schedule *s) {
    gsf_coded_image *file = &s->encoder->coded.file;
    size_t size;
    GSCL_TRY(gscl_coded_image_sort(&s->encoder->coded, NULL));
    GSCL_TRY(gscl_encoder_size(s->encoder, &size));
    while (size > s->bytes && file->header.splat_count > 0) {
        for (size_t excess = (size - s->bytes) / 5 + 1; excess > 0 && file->header.splat_count > 0; excess--)
            drop_smallest(file);
        GSCL_TRY(gscl_encoder_size(s->encoder, &size));
    }
    return GSCL_OK;
}
