#include "scalar/rdo_tables.h"

#include <math.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/quantise.h"
#include "format/attributes.h"
#include "format/count_split.h"
#include "format/quantiser.h"
#include "format/tables.h"
#include "runtime/elementary.h"
#include "scalar/tunables.h"

/* Fails to compile unless kernels and format agree on a number of codes. */
#define ASSERT_CODES_AGREE(name, kernels, format) typedef char name##_agree[(kernels) == (format) ? 1 : -1]
ASSERT_CODES_AGREE(scales, GSCL_MAX_SCALE, GSF_MAX_SCALE_CODE);
ASSERT_CODES_AGREE(waves, GSCL_WAVES, GSF_WAVES);
ASSERT_CODES_AGREE(directions, GSCL_DIRECTIONS, GSF_DIRECTIONS);
ASSERT_CODES_AGREE(direction_rows, GSCL_DIRECTION_ROWS, GSF_DIRECTION_ROWS);
ASSERT_CODES_AGREE(phases, GSCL_PHASES, GSF_PHASES);
ASSERT_CODES_AGREE(fineness, GSCL_MAX_FINENESS, GSF_MAX_FINENESS);
ASSERT_CODES_AGREE(amplitudes, GSCL_AMPLITUDES, GSF_AMPLITUDES);

/* Codes whose occurrences are counted. */
typedef struct code_list {
    const gscl_codes *codes;
    size_t count;
} code_list;

gscl_codes gscl_rdo_codes_of(const gsf_splat *s) {
    const gsf_texture *t = &s->texture;
    return (gscl_codes){.code = {[GSCL_CODE_MAJOR] = s->major,
                                 [GSCL_CODE_ASPECT] = s->aspect,
                                 [GSCL_CODE_ANGLE] = s->angle,
                                 [GSCL_CODE_X] = (int32_t)s->x,
                                 [GSCL_CODE_Y] = (int32_t)s->y,
                                 [GSCL_CODE_LUMA] = s->luma,
                                 [GSCL_CODE_CO] = s->co,
                                 [GSCL_CODE_CG] = s->cg,
                                 [GSCL_CODE_ALPHA] = s->alpha,
                                 [GSCL_CODE_WAVE] = t->wave,
                                 [GSCL_CODE_DIRECTION] = t->direction,
                                 [GSCL_CODE_PHASE] = t->phase,
                                 [GSCL_CODE_AMPLITUDE] = t->amplitude,
                                 [GSCL_CODE_OPACITY] = s->opacity}};
}

gsf_splat gscl_rdo_splat_of(const gscl_codes *c, uint32_t layer) {
    return (gsf_splat){.layer = layer,
                       .major = (uint16_t)c->code[GSCL_CODE_MAJOR],
                       .aspect = (uint16_t)c->code[GSCL_CODE_ASPECT],
                       .angle = (uint16_t)c->code[GSCL_CODE_ANGLE],
                       .x = (uint32_t)c->code[GSCL_CODE_X],
                       .y = (uint32_t)c->code[GSCL_CODE_Y],
                       .luma = (int16_t)c->code[GSCL_CODE_LUMA],
                       .co = (int16_t)c->code[GSCL_CODE_CO],
                       .cg = (int16_t)c->code[GSCL_CODE_CG],
                       .alpha = (int16_t)c->code[GSCL_CODE_ALPHA],
                       .opacity = (uint16_t)c->code[GSCL_CODE_OPACITY],
                       .texture = {.wave = (uint8_t)c->code[GSCL_CODE_WAVE],
                                   .direction = (uint8_t)c->code[GSCL_CODE_DIRECTION],
                                   .phase = (uint8_t)c->code[GSCL_CODE_PHASE],
                                   .amplitude = (uint8_t)c->code[GSCL_CODE_AMPLITUDE]}};
}

gscl_rdo_settings gscl_rdo_settings_of(const gsf_coded_image *image) {
    const gsf_steps *codes = &image->steps;
    float steps[GSCL_STEP_COUNT];
    gscl_steps_to_floats(codes, steps);
    gscl_rdo_settings s = {.scale_step = steps[GSCL_STEP_SCALE],
                           .luma_step = steps[GSCL_STEP_LUMA],
                           .chroma_step = steps[GSCL_STEP_CHROMA],
                           .alpha_step = steps[GSCL_STEP_ALPHA],
                           .amplitude_step = steps[GSCL_STEP_AMPLITUDE],
                           .opacity_levels = steps[GSCL_STEP_OPACITY]};
    gsf_luma_range(image->header.blend, codes->luma, 1, &s.min[0], &s.max[0]);
    gsf_chroma_range(codes->chroma, 1, &s.min[1], &s.max[1]);
    gsf_chroma_range(codes->chroma, 1, &s.min[2], &s.max[2]);
    gsf_luma_range(image->header.blend, codes->alpha, 1, &s.min[3], &s.max[3]);
    return s;
}

/* Occurrences of each value of one code, into counts[value - min]. */
static void count_codes(const code_list *list, int which, int min, double *counts) {
    for (size_t i = 0; i < list->count; i++)
        counts[list->codes[i].code[which] - min]++;
}

/* Turns counts into bits.  Counts borrow from their neighbours, and no code is impossible. */
static void bits_of_counts(const double *counts, int n, float *bits) {
    const double floor = gscl_scalar_tunables.rdo_count_floor, spread = gscl_scalar_tunables.rdo_count_spread;
    double total = 0;
    for (int i = 0; i < n; i++)
        total += counts[i] + floor;
    for (int i = 0; i < n; i++) {
        const double before = i > 0 ? counts[i - 1] : 0, after = i + 1 < n ? counts[i + 1] : 0;
        const double count = (1 - spread) * counts[i] + spread / 2 * (before + after);
        bits[i] = (float)(-gscl_log2((count + floor) / total));
    }
}

/* What the entropy coder expects of the colours, averaged over all splats. */
typedef struct gscl_rdo_expectation {
    gsf_attributes attributes; /* the models after the last splat */
    double probability[4][GSCL_COLOUR_CODES];
} rdo_expectation;

static void add_probabilities(double *sums, const uint16_t *freq, uint32_t count, uint32_t total) {
    for (uint32_t i = 0; i < count; i++)
        sums[i] += (double)freq[i] / total;
}

/* Runs the coder over the splats, which are in the stored order. */
static void expect_codes(rdo_expectation *e, const gsf_coded_image *image, size_t count) {
    gsf_attributes *a = &e->attributes;
    gsf_coder coder;
    memset(e->probability, 0, sizeof e->probability);
    gsf_coder_write_to(&coder, NULL, 0, NULL);
    gsf_attributes_init(a, &image->header, &image->steps);
    for (size_t i = 0; i < count; i++) {
        gsf_splat splat = image->splats[i];
        add_probabilities(e->probability[0], a->luma.freq, a->luma.count, a->luma.total);
        if (image->header.has_alpha)
            add_probabilities(e->probability[3], a->alpha.freq, a->alpha.count, a->alpha.total);
        gsf_code_attributes(&coder, a, &splat);
        for (int k = 0; image->header.has_chroma && k < 2; k++)
            add_probabilities(e->probability[1 + k], a->chroma.channel[k].mixed, a->chroma.channel[k].plain.count,
                              a->chroma.channel[k].mixed_total);
    }
}

/* The bits of aspect codes, from the frequencies of the format's model after all splats. */
static void make_aspect_bits(gscl_rdo_tables *t, const rdo_expectation *e) {
    const unsigned last = gsf_aspect_shape.columns - 1;
    for (unsigned major = 0; major <= GSCL_MAX_SCALE; major++) {
        const unsigned row = gsf_aspect_row(major, e->attributes.typical_size);
        for (unsigned aspect = 0; aspect <= GSCL_MAX_SCALE; aspect++) {
            const double freq = gsf_conditional_row(&e->attributes.aspect, row)[aspect < last ? aspect : last];
            const double codes = aspect < last ? 1 : GSCL_MAX_SCALE + 1 - last;
            t->shape_bits[major][aspect] = (float)-gscl_log2(freq / e->attributes.aspect.total[row] / codes);
        }
    }
}

/* The same for directions. */
static void make_direction_bits(gscl_rdo_tables *t, const rdo_expectation *e) {
    const gsf_conditional *model = &e->attributes.direction;
    for (unsigned row = 0; row < GSCL_DIRECTION_ROWS; row++)
        for (unsigned i = 0; i < GSCL_DIRECTIONS; i++)
            t->direction_bits[row][i] =
                (float)-gscl_log2(GSCL_DIRECTIONS * (double)gsf_conditional_row(model, row)[i] / model->total[row]);
}

/* The bits of majors, from the shares of the splats that the count splits expect after those that exist. */
static void make_major_bits(float *bits, const code_list *list, const rdo_expectation *e) {
    const unsigned typical = e->attributes.typical_size;
    double counts[GSCL_MAX_SCALE + 1] = {0}, left = (double)list->count, rest = 1;
    count_codes(list, GSCL_CODE_MAJOR, 0, counts);
    for (int major = GSCL_MAX_SCALE; major >= 0; major--) {
        const uint16_t *weights =
            gsf_class_weight_table[gsf_size_row((unsigned)major, typical, GSF_CLASS_BELOW, GSF_CLASS_ROWS)];
        const double a = weights[0] / (double)GSF_WEIGHT_UNIT, b = weights[1] / (double)GSF_WEIGHT_UNIT;
        const double share = major > 0 ? (a + counts[major]) / (a + b + left) : 1;
        bits[major] = (float)-gscl_log2(rest * share);
        rest *= 1 - share;
        left -= counts[major];
    }
}

/* The parts of levels of colours, whose bits count as bits of the shape, on which their number depends. */
static void make_fineness(gscl_rdo_tables *t, const gsf_coded_image *image) {
    const double channels = image->header.has_chroma ? 3 : 1;
    for (unsigned major = 0; major <= GSCL_MAX_SCALE; major++)
        for (unsigned aspect = 0; aspect <= major; aspect++) {
            const unsigned fineness = gsf_colour_fineness(&image->steps, major, aspect);
            t->fineness[2 * major - aspect] = (int32_t)fineness;
            t->shape_bits[major][aspect] += (float)(channels * gscl_log2(fineness));
        }
}

static void make_shape_tables(gscl_rdo_tables *t, const gsf_coded_image *image, const code_list *list,
                              const rdo_expectation *e) {
    const gsf_header *header = &image->header;
    float major_bits[GSCL_MAX_SCALE + 1];
    make_major_bits(major_bits, list, e);
    make_aspect_bits(t, e);
    make_fineness(t, image);
    for (unsigned i = 0; i <= GSCL_MAX_SCALE; i++) {
        gscl_major_entry *m = &t->majors[i];
        m->step = (float)gsf_position_step_q8(&image->steps, i) / 256.0f;
        m->cells_x = (int32_t)gsf_position_cells(&image->steps, i, header->width);
        m->cells_y = (int32_t)gsf_position_cells(&image->steps, i, header->height);
        m->bits = major_bits[i] + (float)gscl_log2((float)m->cells_x * (float)m->cells_y);
        gscl_aspect_entry *a = &t->aspects[i];
        a->angles = e->attributes.angles[i];
        a->parts = (int32_t)e->attributes.parts[i];
        a->bits = (float)gscl_log2((float)a->angles * (float)a->parts);
    }
    make_direction_bits(t, e);
}

static void make_colour_tables(gscl_rdo_tables *t, const gscl_rdo_settings *settings, size_t count,
                               const rdo_expectation *e) {
    for (int k = 0; k < 4; k++) {
        const int min = settings->min[k], n = settings->max[k] - min + 1;
        float *bits = t->bits + k * GSCL_COLOUR_CODES + GSCL_COLOUR_CODES / 2 + min;
        for (int i = 0; i < n; i++)
            bits[i] = (float)-gscl_log2(fmax(e->probability[k][i], 1e-9) / (double)count);
    }
}

/* Some splats are assumed to take a wave, any wave: before the first scan there are none to count. */
static void make_texture_tables(gscl_rdo_tables *t, const code_list *list) {
    double waves[GSCL_WAVES], directions[GSCL_DIRECTIONS], amplitudes[GSCL_AMPLITUDES];
    double count = (double)list->count, textured = gscl_scalar_tunables.rdo_textured_share * count;
    for (int i = 0; i < GSCL_WAVES; i++)
        waves[i] = directions[i] = amplitudes[i] = gscl_scalar_tunables.rdo_texture_count;
    for (size_t i = 0; i < list->count; i++) {
        const int32_t *code = list->codes[i].code;
        if (code[GSCL_CODE_AMPLITUDE] == 0)
            continue;
        textured++;
        waves[code[GSCL_CODE_WAVE]]++;
        directions[code[GSCL_CODE_DIRECTION]]++;
        amplitudes[code[GSCL_CODE_AMPLITUDE] - 1]++;
    }
    count *= 1 + gscl_scalar_tunables.rdo_textured_share;
    t->bits[GSCL_BITS_PLAIN] = (float)-gscl_log2(fmax(count - textured, 1) / (count + 1));
    t->bits[GSCL_BITS_TEXTURED] = (float)(gscl_log2(GSCL_PHASES) - gscl_log2(fmax(textured, 1) / (count + 1)));
    bits_of_counts(waves, GSCL_WAVES, t->bits + GSCL_BITS_WAVE);
    bits_of_counts(directions, GSCL_DIRECTIONS, t->bits + GSCL_BITS_DIRECTION);
    bits_of_counts(amplitudes, GSCL_AMPLITUDES, t->bits + GSCL_BITS_AMPLITUDE);
}

void gscl_rdo_tables_make(gscl_rdo_tables *t, const gsf_coded_image *image, const gscl_rdo_settings *settings,
                          const gscl_codes *codes, size_t count) {
    const code_list list = {codes, count};
    double opacities[GSCL_OPACITIES] = {0};
    rdo_expectation e;
    expect_codes(&e, image, count);
    make_shape_tables(t, image, &list, &e);
    make_colour_tables(t, settings, count, &e);
    make_texture_tables(t, &list);
    count_codes(&list, GSCL_CODE_OPACITY, 0, opacities);
    bits_of_counts(opacities, image->steps.opacity + 1, t->bits + GSCL_BITS_OPACITY);
}
