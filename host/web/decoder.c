/* The decoder as a WebAssembly module, for decoder.js: format/ and the software renderer without a context.
 *
 * An instance reads one file.  The calls come in this order: web_file, web_header, web_read, then web_splats, or web_frame
 * and web_draw. */
#include <stdbool.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "decode/coded_image.h"
#include "decode/frame.h"
#include "decode/resize.h"
#include "format/format.h"
#include "format/packet.h"
#include "software/software.h"

#define EXPORT(name) __attribute__((export_name(name)))

static uint8_t *bytes; /* the file */
static size_t size;
static gscl_coded_image coded;
static gscl_frame frame;

EXPORT("file") uint8_t *web_file(size_t file_size, bool bare);
EXPORT("header") gsf_result web_header(void);
EXPORT("info") const uint32_t *web_info(void);
EXPORT("read") gsf_result web_read(bool partial);
EXPORT("splats") float *web_splats(void);
EXPORT("frame")
double web_frame(uint32_t full_width, uint32_t full_height, uint32_t x, uint32_t y, uint32_t width, uint32_t height);
EXPORT("draw") const void *web_draw(void);

/* Makes room for a file, or a list of packets; NULL without memory. */
uint8_t *web_file(size_t file_size, bool bare) {
    size = file_size;
    coded.file.bare = bare;
    return bytes = malloc(size);
}

/* Computes the packets that a list lacks, where it has repair packets for them. */
static gsf_result repair(void) {
    uint8_t *repaired;
    size_t repaired_size;
    if (gscl_repair_list(bytes, size, &repaired, &repaired_size) != GSCL_OK)
        return GSF_NO_SPACE;
    if (repaired) {
        bytes = repaired;
        size = repaired_size;
    }
    return GSF_OK;
}

gsf_result web_header(void) {
    if (!coded.file.bare && gsf_is_packet_list(bytes, size) && repair() != GSF_OK)
        return GSF_NO_SPACE;
    return gsf_read_header(bytes, size, coded.file.bare, &coded.file.header);
}

/* The header as decoder.js takes it.  After web_read of a part of a file the splats are those that it holds. */
const uint32_t *web_info(void) {
    static uint32_t fields[10];
    const gsf_header *h = &coded.file.header;
    fields[0] = h->width;
    fields[1] = h->height;
    fields[2] = h->splat_count;
    fields[3] = h->layout;
    fields[4] = h->enhancement_layers;
    fields[5] = h->high_bit_depth;
    fields[6] = h->has_chroma ? 3 : 1;
    fields[7] = h->has_alpha;
    fields[8] = h->has_opacity;
    fields[9] = h->blend;
    return fields;
}

/* Memory for the file, whatever its coding.  The arrays follow each other, each of a multiple of 8 bytes. */
static bool reserve(gsf_coded_image *file) {
    const size_t count = file->header.splat_count;
    const size_t splat = sizeof *file->splats + sizeof *file->indexed;
    const size_t word = sizeof *file->codebooks.shape_words + sizeof *file->codebooks.colour_words;
    file->splats = malloc(count * splat + GSF_MAX_CODEBOOK * word + gsf_read_scratch_size(&file->header));
    file->indexed = (gsf_indexed_splat *)(file->splats + count);
    file->codebooks.shape_words = (uint16_t(*)[GSF_SHAPE_DIMS])(file->indexed + count);
    file->codebooks.colour_words = (uint16_t(*)[GSF_MAX_COLOUR_DIMS])(file->codebooks.shape_words + GSF_MAX_CODEBOOK);
    coded.scratch = file->codebooks.colour_words + GSF_MAX_CODEBOOK;
    return file->splats;
}

gsf_result web_read(bool partial) {
    uint32_t total;
    if (!reserve(&coded.file))
        return GSF_NO_SPACE;
    return partial ? gsf_read_prefix(bytes, size, &coded.file, &total, coded.scratch)
                   : gsf_read(bytes, size, &coded.file, coded.scratch);
}

/* GSCL_PARAMS parameters of each splat, then the background of 4 channels; NULL without memory. */
float *web_splats(void) {
    const uint32_t count = coded.file.header.splat_count;
    float *params = malloc((count * GSCL_PARAMS + 4) * sizeof *params);
    if (params)
        gscl_coded_image_params(&coded, params, params + count * GSCL_PARAMS);
    return params;
}

/* Sets the rectangle of the whole drawn image that web_draw draws.  The rectangle must have at most GSCL_MAX_DIMENSION
 * pixels a side; the whole image may be larger than gscl_decode allows, so that pages can zoom far.  Returns what max_work
 * limits. */
double web_frame(uint32_t full_width, uint32_t full_height, uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    frame = (gscl_frame){.full_width = full_width,
                         .full_height = full_height,
                         .x = x,
                         .y = y,
                         .width = width,
                         .height = height,
                         .scale_x = (double)full_width / coded.file.header.width,
                         .scale_y = (double)full_height / coded.file.header.height};
    return (double)gscl_frame_work(&coded.file, &frame);
}

/* The options of gscl_frame_options, or those for more effects; the format and the kernels number blend modes alike. */
static const gscl_kernel_options *options_of(const gsf_header *h) {
    static gscl_kernel_options options = {.shape = GSCL_SHAPE_ROTATED, .opacity = true};
    options.blend = (int)h->blend;
    options.colours = h->has_chroma ? 3 : 1;
    options.alpha_channel = h->has_alpha;
    options.texture = h->has_texture;
    return &options;
}

/* Pixels of 4 bytes, R, G, B and alpha, whatever the layout of the file; NULL without memory. */
const void *web_draw(void) {
    const gscl_software_view view = {frame.width, frame.height, 0, 0};
    const gscl_image image = {.width = frame.width,
                              .height = frame.height,
                              .channels = 4,
                              .sample = GSCL_SAMPLE_U8,
                              .pixels = malloc((size_t)4 * frame.width * frame.height)};
    const uint32_t count = coded.file.header.splat_count;
    gscl_software *software = gscl_software_create(options_of(&coded.file.header), &view, count);
    float *params = web_splats();
    if (!software || !image.pixels || !params)
        return NULL;
    gscl_resize_splats(params, count, frame.scale_x, frame.scale_y);
    for (uint32_t i = 0; i < count; i++, params += GSCL_PARAMS) {
        params[GSCL_X] -= (float)frame.x;
        params[GSCL_Y] -= (float)frame.y;
        gscl_software_add(software, params);
    }
    gscl_software_draw(software, params, &image); /* the background follows the splats */
    return image.pixels;
}
