#include "decode/quantise.h"

#include <math.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/dequantise.h"
#include "decode/tunables.h"
#include "decode/ycocg.h"
#include "runtime/elementary.h"

#define COLOUR_STEPS 16 /* number of steps that the format offers */

static const double pi = 3.14159265358979323846, ln2 = 0.69314718055994530942;

/* The nearest code within its range; x may be beyond the range of int. */
static int nearest_code(double x, int min, int max) {
    return (int)rint(fmin(fmax(x, min), max));
}

void gscl_steps_to_floats(const gsf_steps *s, float *f) {
    memset(f, 0, GSCL_STEP_COUNT * sizeof *f);
    f[GSCL_STEP_SCALE] = (float)gscl_scale_step(s);
    f[GSCL_STEP_POSITION] = (float)(s->position + 2) / 32.0f;
    f[GSCL_STEP_ANGLE] = (float)(s->angle + 2) / 16.0f;
    f[GSCL_STEP_LUMA] = 1.0f / (float)gsf_colour_levels(s->luma);
    f[GSCL_STEP_CHROMA] = 1.0f / (float)gsf_colour_levels(s->chroma);
    f[GSCL_STEP_ALPHA] = 1.0f / (float)gsf_colour_levels(s->alpha);
    f[GSCL_STEP_OPACITY] = (float)(s->opacity + 1);
    f[GSCL_STEP_AMPLITUDE] = (float)gscl_amplitude_step(s);
    for (int i = 0; i < GSCL_MAX_FINENESS - 1; i++)
        f[GSCL_STEP_FINER + i] = (float)(2 * s->pivot * (s->scale + 4) + gsf_finer_from[i]) - 0.5f;
}

/* The code whose step is nearest to `factor` times that of `code`; steps are in proportion to code + offset. */
static uint8_t scaled_code(uint8_t code, int offset, double factor) {
    double scaled = rint((code + offset) * factor) - offset;
    return (uint8_t)fmin(fmax(scaled, 0), 15);
}

/* The same for colours, whose codes stand for numbers of levels. */
static uint8_t scaled_levels(uint8_t code, double factor) {
    double levels = gsf_colour_levels(code) / factor;
    unsigned best = 0;
    for (unsigned i = 1; i < COLOUR_STEPS; i++)
        if (fabs(gscl_ln(gsf_colour_levels(i) / levels)) < fabs(gscl_ln(gsf_colour_levels(best) / levels)))
            best = i;
    return (uint8_t)best;
}

gsf_steps gscl_scale_steps(const gsf_steps *s, double factor) {
    return (gsf_steps){.scale = scaled_code(s->scale, 4, factor),
                       .position = scaled_code(s->position, 2, factor),
                       .angle = scaled_code(s->angle, 2, factor),
                       .luma = scaled_levels(s->luma, factor),
                       .chroma = scaled_levels(s->chroma, factor),
                       .alpha = scaled_levels(s->alpha, factor),
                       .opacity = s->opacity,
                       .pivot = s->pivot};
}

uint16_t gscl_quantise_background(const gsf_header *header, float value) {
    float v = value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value;
    return (uint16_t)(v * (header->high_bit_depth ? 65535.0f : 255.0f) + 0.5f);
}

/* Colour codes of a splat whose axes' codes have been set. */
static void quantise_colour(const gsf_coded_image *p, const float *colour, gsf_splat *s) {
    const unsigned fineness = gsf_colour_fineness(&p->steps, s->major, s->aspect);
    double luma = gsf_colour_levels(p->steps.luma) * fineness, chroma = gsf_colour_levels(p->steps.chroma) * fineness;
    int min, max;
    double y = colour[0];
    gsf_luma_range(p->header.blend, p->steps.luma, fineness, &min, &max);
    if (p->header.has_chroma) {
        const gscl_ycocg c = gscl_ycocg_from_rgb(colour);
        int chroma_min, chroma_max;
        gsf_chroma_range(p->steps.chroma, fineness, &chroma_min, &chroma_max);
        s->co = (int16_t)nearest_code(c.co * chroma, chroma_min, chroma_max);
        s->cg = (int16_t)nearest_code(c.cg * chroma, chroma_min, chroma_max);
        y = c.y;
    }
    s->luma = (int16_t)nearest_code(y * luma, min, max);
    if (p->header.has_alpha) {
        gsf_luma_range(p->header.blend, p->steps.alpha, 1, &min, &max);
        s->alpha =
            (int16_t)nearest_code(colour[p->header.has_chroma ? 3 : 1] * gsf_colour_levels(p->steps.alpha), min, max);
    }
}

static uint32_t nearest_cell(double x, double step, uint32_t cells) {
    double cell = floor(x / step);
    return cell <= 0 ? 0 : cell >= cells ? cells - 1 : (uint32_t)cell;
}

/* Position codes of a splat whose other geometry has been coded.  The cells are long along the major axis and follow
 * one axis of the image, so that rounding along that axis moves the centre along the major axis. */
static void quantise_position(const gsf_coded_image *p, const float *params, gsf_splat *s) {
    const gsf_splat_grid grid = gsf_splat_grid_of(&p->header, &p->steps, s);
    const double step_x = grid.step / 256.0 / grid.parts_x, step_y = grid.step / 256.0 / grid.parts_y;
    const double theta = p->header.has_rotation ? s->angle * pi / gsf_angle_count(&p->steps, s->aspect) : 0;
    double x = params[GSCL_X], y = params[GSCL_Y];
    if (grid.parts_x > 1) {
        s->y = nearest_cell(y, step_y, grid.cells_y);
        x += ((s->y + 0.5) * step_y - y) / gscl_tan(theta);
        s->x = nearest_cell(x, step_x, grid.cells_x);
    } else {
        s->x = nearest_cell(x, step_x, grid.cells_x);
        if (grid.parts_y > 1)
            y += ((s->x + 0.5) * step_x - x) * gscl_tan(theta);
        s->y = nearest_cell(y, step_y, grid.cells_y);
    }
}

/* Angle code of a splat whose axes' codes have been set. */
static uint16_t quantise_angle(const gsf_coded_image *p, const float *params, const gsf_splat *s) {
    int count = (int)gsf_angle_count(&p->steps, s->aspect);
    double turn = params[GSCL_LOG_S1] < params[GSCL_LOG_S2] ? pi / 2 : 0; /* codes count from the major axis */
    double code = fmod(rint((params[GSCL_THETA] + turn) * count / pi), count);
    return (uint16_t)(code < 0 ? code + count : code);
}

static void quantise_texture(const gsf_coded_image *p, const float *params, gsf_texture *t) {
    double x = params[GSCL_WAVE_X], y = params[GSCL_WAVE_Y];
    double amplitude = rint(params[GSCL_WAVE_AMPLITUDE] / gscl_amplitude_step(&p->steps));
    if (!p->header.has_texture || amplitude < 1)
        return;
    t->amplitude = (uint8_t)fmin(amplitude, GSF_AMPLITUDES);
    t->wave = (uint8_t)nearest_code(-gscl_log2(gscl_hypot(x, y) * GSCL_FIRST_WAVELENGTH) / GSCL_OCTAVES_PER_WAVE, 0,
                                    GSF_WAVES - 1);
    t->direction = (uint8_t)(((int)lrint(gscl_atan2(y, x) * GSF_DIRECTIONS / pi) + GSF_DIRECTIONS) % GSF_DIRECTIONS);
    double turns = params[GSCL_WAVE_PHASE] - floor(params[GSCL_WAVE_PHASE]);
    t->phase = (uint8_t)((int)lrint(turns * GSF_PHASES) % GSF_PHASES);
}

void gscl_quantise(const gsf_coded_image *p, const float *params, gsf_splat *s) {
    double step = gscl_scale_step(&p->steps);
    memset(s, 0, sizeof *s);
    int a = nearest_code((params[GSCL_LOG_S1] + ln2) / step, 0, GSF_MAX_SCALE_CODE);
    int b = nearest_code((params[GSCL_LOG_S2] + ln2) / step, 0, GSF_MAX_SCALE_CODE);
    if (!p->header.has_anisotropy)
        a = b = nearest_code(((params[GSCL_LOG_S1] + params[GSCL_LOG_S2]) / 2 + ln2) / step, 0, GSF_MAX_SCALE_CODE);
    s->major = (uint16_t)(a < b ? b : a);
    s->aspect = (uint16_t)(a < b ? b - a : a - b);
    s->angle = p->header.has_rotation ? quantise_angle(p, params, s) : 0;
    quantise_position(p, params, s);
    quantise_colour(p, params + GSCL_COLOUR, s);
    quantise_texture(p, params, &s->texture);
    if (p->header.has_opacity) {
        int levels = p->steps.opacity + 1;
        double opacity = 1 / (1 + gscl_exp(-params[GSCL_OPACITY]));
        s->opacity = (uint16_t)(nearest_code(opacity * levels, 1, levels) - 1);
    }
}

/* Squared error of the colour of a circle of the pivot's size after coding, per sample, in (1/255)^2. */
static double coded_colour_error(const gsf_coded_image *p, const float *colour) {
    gsf_splat splat = {.major = p->steps.pivot};
    float coded[4] = {0};
    double sum = 0;
    unsigned channels = gsf_channel_count(&p->header);
    quantise_colour(p, colour, &splat);
    gscl_dequantise_colour(p, &splat, coded);
    for (unsigned k = 0; k < channels; k++)
        sum += 255 * 255 * (double)(coded[k] - colour[k]) * (double)(coded[k] - colour[k]);
    return sum / channels;
}

void gscl_fit_steps_to_colour(gsf_coded_image *p, const float *colour) {
    const gsf_steps initial = p->steps;
    gsf_steps best = initial;
    const int max_luma = initial.luma + gscl_decode_tunables.max_finer_luma;
    const int max_chroma = initial.chroma + (p->header.has_chroma ? gscl_decode_tunables.max_finer_chroma : 0);
    double lowest = INFINITY;
    for (int luma = initial.luma; luma <= max_luma && luma < COLOUR_STEPS; luma++)
        for (int chroma = initial.chroma; chroma <= max_chroma && chroma < COLOUR_STEPS; chroma++) {
            p->steps.luma = (uint8_t)luma;
            p->steps.chroma = (uint8_t)chroma;
            double finer_luma = gsf_colour_levels(p->steps.luma) / (double)gsf_colour_levels(initial.luma);
            double finer_chroma = gsf_colour_levels(p->steps.chroma) / (double)gsf_colour_levels(initial.chroma);
            double bits = gscl_log2(finer_luma) + 2 * gscl_log2(finer_chroma);
            double cost = coded_colour_error(p, colour) + gscl_decode_tunables.error_per_bit * bits;
            if (cost < lowest) {
                lowest = cost;
                best = p->steps;
            }
        }
    p->steps = best;
}
