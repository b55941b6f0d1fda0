#include "decode/output.h"

#include <string.h>

#include "decode/ycocg.h"
#include "image/image.h"
#include "software/samples.h"

#define PART 64 /* pixels that are mixed at once */

/* ---- What is drawn ---- */

bool gscl_output_is_possible(const gscl_decode_settings *s) {
    bool is_possible = (unsigned)s->sample <= GSCL_SAMPLE_F32 &&
                       (s->layout == GSCL_LAYOUT_AUTO || gscl_layout_channels(s->layout) > 0);
    for (int k = 0; k < 3; k++)
        is_possible &= s->background[k] >= 0 && s->background[k] <= 1;
    return is_possible;
}

static gscl_image returned_image(const gscl_frame *f, const gscl_decode_settings *s, const gsf_header *header) {
    const gscl_sample as_coded = header->high_bit_depth ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8;
    const uint32_t channels = gscl_layout_channels(s->layout);
    return (gscl_image){.width = f->width,
                        .height = f->height,
                        .channels = channels ? channels : gscl_coded_image_channels(header),
                        .sample = s->sample != GSCL_SAMPLE_AUTO ? s->sample : as_coded,
                        .premultiplied = s->premultiplied,
                        .layout = s->layout};
}

/* Drawn pixels that are mixed are never smaller than what becomes of them, so that they may lie in the same memory. */
static gscl_image mixed_image(const gscl_image *returned, const gsf_header *header) {
    gscl_image drawn = *returned;
    drawn.channels = (header->has_chroma || returned->channels >= 3 ? 3 : 1) + header->has_alpha;
    drawn.sample = GSCL_SAMPLE_F32;
    drawn.premultiplied = true;
    return drawn;
}

gscl_output gscl_output_of(const gscl_frame *f, const gscl_decode_settings *s, const gsf_header *header) {
    gscl_output o = {.image = returned_image(f, s, header)};
    const bool loses_alpha = header->has_alpha && o.image.channels % 2 == 1;
    const bool loses_chroma = header->has_chroma && o.image.channels < 3;
    o.is_mixed = loses_alpha || loses_chroma;
    o.drawn = o.is_mixed ? mixed_image(&o.image, header) : o.image;
    memcpy(o.background, s->background, sizeof o.background);
    if (o.drawn.channels < 3)
        o.background[0] = (float)gscl_ycocg_from_rgb(s->background).y;
    return o;
}

gscl_image gscl_output_target(const gscl_output *o, const gscl_image *rows, void *scratch) {
    gscl_image target = o->drawn;
    target.height = rows->height;
    target.stride = scratch ? 0 : rows->stride;
    target.pixels = scratch ? scratch : rows->pixels;
    return target;
}

/* ---- What becomes of it ---- */

/* Channels of some pixels, colours premultiplied, alpha behind them. */
typedef float planes[4][PART];

static void load_planes(const unsigned char *from, uint32_t channels, int count, planes to) {
    for (int i = 0; i < count; i++)
        for (uint32_t k = 0; k < channels; k++, from += sizeof to[k][i])
            memcpy(&to[k][i], from, sizeof to[k][i]);
}

static void add_background(planes p, int colours, int count, const float background[3]) {
    for (int k = 0; k < colours; k++)
        for (int i = 0; i < count; i++)
            p[k][i] += (1.0f - p[colours][i]) * background[k];
}

/* The luma, exact where colours are equal. */
static void make_grey(planes p, int count) {
    for (int i = 0; i < count; i++)
        p[0][i] = p[1][i] + ((p[0][i] - p[1][i]) + (p[2][i] - p[1][i])) / 4.0f;
}

/* Computes `count` returned pixels of drawn ones, which may begin at the same address. */
static void mix_pixels(const gscl_output *o, const unsigned char *drawn, unsigned char *returned, int count) {
    const int colours = o->drawn.channels >= 3 ? 3 : 1, returned_colours = o->image.channels >= 3 ? 3 : 1;
    const bool has_alpha = o->drawn.channels % 2 == 0, returns_alpha = o->image.channels % 2 == 0;
    planes p = {{0}}; /* set for analysers */
    load_planes(drawn, o->drawn.channels, count, p);
    if (has_alpha && !returns_alpha)
        add_background(p, colours, count, o->background);
    if (returned_colours < colours)
        make_grey(p, count);
    float *const values[4] = {p[0], returned_colours == 3 ? p[1] : p[colours], p[2], p[3]};
    gscl_store_samples(&o->image, values, returned_colours, has_alpha && returns_alpha, count, returned);
}

static void mix_row(const gscl_output *o, const unsigned char *drawn, unsigned char *returned) {
    const size_t from = o->drawn.channels * sizeof(float), to = o->image.channels * gscl_sample_size(o->image.sample);
    for (uint32_t x = 0; x < o->image.width; x += PART) {
        const uint32_t left = o->image.width - x;
        mix_pixels(o, drawn + x * from, returned + x * to, left < PART ? (int)left : PART);
    }
}

/* Swaps red and blue of a row. */
static void swap_colours(const gscl_image *image, unsigned char *row) {
    const size_t size = gscl_sample_size(image->sample);
    for (uint32_t x = 0; x < image->width; x++, row += image->channels * size) {
        unsigned char red[sizeof(float)];
        memcpy(red, row, size);
        memcpy(row, row + 2 * size, size);
        memcpy(row + 2 * size, red, size);
    }
}

void gscl_output_finish(const gscl_output *o, const gscl_image *target, const gscl_image *rows) {
    for (uint32_t y = 0; y < rows->height; y++) {
        const unsigned char *drawn = gscl_image_row(target, y);
        unsigned char *returned = gscl_image_row(rows, y);
        if (o->is_mixed)
            mix_row(o, drawn, returned);
        else if (drawn != returned)
            memcpy(returned, drawn, gscl_image_row_size(rows));
        if (gscl_layout_is_bgr(rows->layout))
            swap_colours(rows, returned);
    }
}
