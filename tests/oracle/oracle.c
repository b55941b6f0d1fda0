/* Reading of the codes and allocation. */
#include "oracle.h"

#include <stdlib.h>
#include <string.h>

/* A coded image with the arrays that its header asks for. */
typedef struct {
    gsf_coded_image image;
    uint16_t shape_words[GSF_MAX_CODEBOOK][GSF_SHAPE_DIMS];
    uint16_t colour_words[GSF_MAX_CODEBOOK][GSF_MAX_COLOUR_DIMS];
} coded_file;

static void coded_free(coded_file *coded) {
    free(coded->image.splats);
    free(coded->image.indexed);
    free(coded);
}

static coded_file *coded_read(const uint8_t *bytes, size_t size) {
    coded_file *coded = calloc(1, sizeof *coded);
    if (!coded)
        return NULL;
    gsf_coded_image *image = &coded->image;
    bool done = gsf_read_header(bytes, size, false, &image->header) == GSF_OK;
    if (done) {
        void *scratch = malloc(gsf_scratch_size(&image->header));
        image->splats = calloc(image->header.splat_count + (size_t)1, sizeof *image->splats);
        image->indexed = calloc(image->header.splat_count + (size_t)1, sizeof *image->indexed);
        image->codebooks.shape_words = coded->shape_words;
        image->codebooks.colour_words = coded->colour_words;
        done = scratch && image->splats && image->indexed && gsf_read(bytes, size, image, scratch) == GSF_OK;
        free(scratch);
    }
    if (done)
        return coded;
    coded_free(coded);
    return NULL;
}

static oracle_header header_of(const gsf_header *header) {
    const uint32_t colours = header->has_chroma ? 3 : 1;
    return (oracle_header){.width = header->width,
                           .height = header->height,
                           .splats = header->splat_count,
                           .blend = (oracle_blend)header->blend,
                           .layout = (uint32_t)header->layout,
                           .high_bit_depth = header->high_bit_depth,
                           .has_chroma = header->has_chroma,
                           .has_alpha = header->has_alpha,
                           .colours = colours,
                           .channels = colours + (header->has_alpha ? 1 : 0)};
}

bool oracle_read(const uint8_t *bytes, size_t size, oracle_image *image) {
    memset(image, 0, sizeof *image);
    coded_file *coded = coded_read(bytes, size);
    if (!coded)
        return false;
    image->header = header_of(&coded->image.header);
    image->samples = (image->header.layout >= 2 ? 3 : 1) + (image->header.layout & 1);
    image->splats = calloc(image->header.splats + (size_t)1, sizeof *image->splats);
    if (image->splats)
        oracle_dequantise(&coded->image, image);
    coded_free(coded);
    return image->splats != NULL;
}

static bool draw_image(oracle_image *image) {
    const size_t pixels = (size_t)image->header.width * image->header.height;
    const size_t samples = pixels * image->samples;
    double *values = calloc(pixels * image->header.channels, sizeof *values);
    oracle_sums *sums = calloc(pixels, sizeof *sums);
    image->pixels = calloc(3 * samples, sizeof *image->pixels);
    const bool done = values && sums && image->pixels;
    if (done) {
        image->low = image->pixels + samples;
        image->high = image->low + samples;
        oracle_draw(image, values, sums);
        oracle_output(image, values, sums);
    }
    free(values);
    free(sums);
    return done;
}

bool oracle_decode(const uint8_t *bytes, size_t size, oracle_image *image) {
    return oracle_read(bytes, size, image) && draw_image(image);
}

void oracle_free(oracle_image *image) {
    free(image->splats);
    free(image->pixels);
    image->splats = NULL;
    image->pixels = image->low = image->high = NULL;
}
