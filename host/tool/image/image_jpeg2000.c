#include "image/image_jpeg2000.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <openjpeg.h>

/* Kinds of alpha of a component (ISO/IEC 15444-1, I.5.3.6). */
enum { ALPHA_NONE = 0, ALPHA_PREMULTIPLIED = 2 }; /* 1: straight */

/* ---- Bytes in memory ----------------------------------------------------------------------------- */

typedef struct source {
    const uint8_t *bytes;
    size_t size, position;
} source;

static OPJ_SIZE_T on_read(void *buffer, OPJ_SIZE_T count, void *data) {
    source *s = data;
    const size_t left = s->size - s->position, step = count < left ? count : left;
    if (left == 0)
        return (OPJ_SIZE_T)-1;
    memcpy(buffer, s->bytes + s->position, step);
    s->position += step;
    return step;
}

static OPJ_OFF_T on_skip(OPJ_OFF_T count, void *data) {
    source *s = data;
    const size_t left = s->size - s->position;
    if (count < 0)
        return -1;
    const size_t step = (uint64_t)count < left ? (size_t)count : left;
    s->position += step;
    return (OPJ_OFF_T)step;
}

static OPJ_BOOL on_seek(OPJ_OFF_T position, void *data) {
    source *s = data;
    if (position < 0 || (uint64_t)position > s->size)
        return OPJ_FALSE;
    s->position = (size_t)position;
    return OPJ_TRUE;
}

static opj_stream_t *open_stream(source *s) {
    opj_stream_t *stream = opj_stream_default_create(OPJ_TRUE);
    if (!stream)
        return NULL;
    opj_stream_set_user_data(stream, s, NULL);
    opj_stream_set_user_data_length(stream, s->size);
    opj_stream_set_read_function(stream, on_read);
    opj_stream_set_skip_function(stream, on_skip);
    opj_stream_set_seek_function(stream, on_seek);
    return stream;
}

/* Keeps the first error. */
static void on_error(const char *text, void *data) {
    char *message = data;
    if (!*message)
        snprintf(message, IMAGE_MESSAGE_SIZE, "cannot be read: %s", text);
}

/* ---- What the header says ------------------------------------------------------------------------ */

static bool refuse(char *message, const char *phrase) {
    snprintf(message, IMAGE_MESSAGE_SIZE, "%s", phrase);
    return false;
}

/* Whether the components are those of an image that gscl takes. */
static bool check_components(const opj_image_t *image, char *message) {
    if (image->numcomps < 1 || image->numcomps > 4)
        return refuse(message, "has other channels than grey or RGB, with or without alpha");
    for (OPJ_UINT32 c = 0; c < image->numcomps; c++) {
        const opj_image_comp_t *component = &image->comps[c];
        if (component->dx < 1 || component->dy < 1 || component->prec < 1 || component->prec > 16)
            return refuse(message, "holds samples of more than 16 bits; convert it to PNG first");
    }
    return true;
}

static bool check_header(const opj_image_t *image, char *message) {
    const uint32_t width = image->x1 - image->x0, height = image->y1 - image->y0;
    if (width < 1 || height < 1 || width > GSCL_MAX_DIMENSION || height > GSCL_MAX_DIMENSION) {
        snprintf(message, IMAGE_MESSAGE_SIZE, IMAGE_SIZE_MESSAGE, width, height);
        return false;
    }
    return check_components(image, message);
}

/* Whether colours and alpha are of a kind that gscl takes.  Known only after decoding. */
static bool check_meaning(const opj_image_t *image, char *message) {
    for (OPJ_UINT32 c = 0; c < image->numcomps; c++) {
        const bool may_be_alpha = c % 2 == 1 && c + 1 == image->numcomps;
        if (image->comps[c].alpha > (may_be_alpha ? ALPHA_PREMULTIPLIED : ALPHA_NONE))
            return refuse(message, "has a channel of unknown meaning; grey or RGB, with or without alpha, is needed");
    }
    if (image->color_space == OPJ_CLRSPC_CMYK)
        return refuse(message, "holds CMYK colours; convert it to RGB first");
    if (image->color_space == OPJ_CLRSPC_EYCC || (image->icc_profile_buf && image->icc_profile_len == 0))
        return refuse(message, "holds colours that are neither RGB, grey nor YCC; convert it to RGB first");
    return true;
}

/* Whether components are luma and two of chroma: some writers leave out the colour space, but not the subsampling. */
static bool holds_ycc(const opj_image_t *image) {
    return image->numcomps >= 3 &&
           (image->color_space == OPJ_CLRSPC_SYCC || (image->comps[0].dx == 1 && image->comps[1].dx > 1));
}

/* ---- Samples ----------------------------------------------------------------------------------- */

/* The sample of a component at a pixel of the image, 0..peak. */
static int32_t sample_at(const opj_image_t *image, const opj_image_comp_t *component, uint32_t x, uint32_t y,
                         int32_t peak) {
    uint32_t column = (image->x0 + x) / component->dx, row = (image->y0 + y) / component->dy;
    column = column > component->x0 ? column - component->x0 : 0;
    row = row > component->y0 ? row - component->y0 : 0;
    column = column < component->w ? column : component->w - 1;
    row = row < component->h ? row : component->h - 1;
    const int32_t value = component->data[(size_t)row * component->w + column] + (component->sgnd ? (peak + 1) / 2 : 0);
    return value < 0 ? 0 : value > peak ? peak : value;
}

static double clamp(double v) {
    return v < 0.0 ? 0.0 : v > 1.0 ? 1.0 : v;
}

/* Full-range YCC of ITU-R BT.601 (sYCC, IEC 61966-2-1, amendment 1). */
static void ycc_to_rgb(double pixel[4]) {
    const double y = pixel[0], cb = pixel[1] - 0.5, cr = pixel[2] - 0.5;
    pixel[0] = clamp(y + 1.402 * cr);
    pixel[1] = clamp(y - 0.344136 * cb - 0.714136 * cr);
    pixel[2] = clamp(y + 1.772 * cb);
}

static void copy_row(const opj_image_t *from, uint32_t y, gscl_image *to) {
    const bool is_ycc = holds_ycc(from);
    const size_t start = (size_t)y * to->width * to->channels;
    for (uint32_t x = 0; x < to->width; x++) {
        double pixel[4];
        for (uint32_t c = 0; c < to->channels; c++) {
            const int32_t peak = (int32_t)((1u << from->comps[c].prec) - 1);
            pixel[c] = (double)sample_at(from, &from->comps[c], x, y, peak) / peak;
        }
        if (is_ycc)
            ycc_to_rgb(pixel);
        for (uint32_t c = 0; c < to->channels; c++) {
            const size_t at = start + (size_t)x * to->channels + c;
            if (to->sample == GSCL_SAMPLE_U8)
                ((uint8_t *)to->pixels)[at] = (uint8_t)(pixel[c] * 255.0 + 0.5);
            else
                ((uint16_t *)to->pixels)[at] = (uint16_t)(pixel[c] * 65535.0 + 0.5);
        }
    }
}

static bool copy_samples(const opj_image_t *from, image_content *content, char *message) {
    gscl_image *to = &content->image;
    to->width = from->x1 - from->x0;
    to->height = from->y1 - from->y0;
    to->channels = from->numcomps;
    to->sample = GSCL_SAMPLE_U8;
    for (OPJ_UINT32 c = 0; c < from->numcomps; c++) {
        if (!from->comps[c].data || from->comps[c].w < 1 || from->comps[c].h < 1)
            return refuse(message, "cannot be read: the file is truncated or damaged");
        if (from->comps[c].prec > 8)
            to->sample = GSCL_SAMPLE_U16;
    }
    to->premultiplied = from->comps[from->numcomps - 1].alpha == ALPHA_PREMULTIPLIED;
    to->pixels = malloc((size_t)to->width * to->height * to->channels * (to->sample == GSCL_SAMPLE_U8 ? 1 : 2));
    if (!to->pixels)
        return refuse(message, "is too large for the available memory");
    for (uint32_t y = 0; y < to->height; y++)
        copy_row(from, y, to);
    return true;
}

/* ---- The file ---------------------------------------------------------------------------------- */

static bool decode(opj_codec_t *codec, opj_stream_t *stream, opj_image_t **image, char *message) {
    opj_dparameters_t parameters;
    opj_set_default_decoder_parameters(&parameters);
    opj_set_error_handler(codec, on_error, message);
    return opj_setup_decoder(codec, &parameters) && opj_read_header(stream, codec, image) &&
           check_header(*image, message) && opj_decode(codec, stream, *image) && opj_end_decompress(codec, stream);
}

bool image_read_jpeg2000(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]) {
    source s = {bytes, size, 0};
    const bool is_code_stream = size > 0 && bytes[0] == 0xFF;
    opj_stream_t *stream = open_stream(&s);
    opj_codec_t *codec = opj_create_decompress(is_code_stream ? OPJ_CODEC_J2K : OPJ_CODEC_JP2);
    opj_image_t *image = NULL;
    *message = '\0';
    bool ok = stream && codec && decode(codec, stream, &image, message) && check_meaning(image, message) &&
              copy_samples(image, content, message);
    if (ok && image->icc_profile_buf)
        content->damaged_profile =
            !image_blob_set(&content->metadata.icc, image->icc_profile_buf, image->icc_profile_len);
    if (!ok && !*message)
        refuse(message, "cannot be read: the file is truncated or damaged");
    opj_image_destroy(image);
    opj_destroy_codec(codec);
    opj_stream_destroy(stream);
    return ok;
}
