#include "format/check.h"

#include "format/classes.h"
#include "format/codebooks.h"
#include "format/container.h"
#include "format/header.h"
#include "format/quantiser.h"

static uint32_t whole_pixels(uint64_t q16) {
    return (uint32_t)((q16 + 65535) >> 16);
}

static uint64_t larger(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

/* The two sigmas of a splat in whole pixels, rounded up. */
static void splat_axes(const gsf_coded_image *image, uint32_t splat, uint64_t axes[2]) {
    if (image->header.coding == GSF_CODING_SCALAR) {
        const gsf_splat *s = &image->splats[splat];
        axes[0] = whole_pixels(gsf_sigma_q16(&image->steps, s->major));
        axes[1] = whole_pixels(gsf_sigma_q16(&image->steps, (unsigned)s->major - s->aspect));
    } else {
        axes[0] = gsf_shape_sigma(&image->codebooks, image->indexed[splat].shape, 0);
        axes[1] = gsf_shape_sigma(&image->codebooks, image->indexed[splat].shape, 1);
    }
}

bool gsf_work_is_bounded(const gsf_coded_image *image) {
    const uint64_t pixels = (uint64_t)image->header.width * image->header.height;
    uint64_t work = 0, axes[2];
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        splat_axes(image, i, axes);
        const uint64_t s1 = larger(axes[0], (axes[1] + 255) / 256), s2 = larger(axes[1], (axes[0] + 255) / 256);
        const uint64_t area = 48 * s1 * s2 + 16 * (s1 + s2) + 16;
        work += area < pixels ? area : pixels;
    }
    return work <= 256 * pixels + (UINT64_C(1) << 26);
}

static bool background_is_valid(const gsf_coded_image *image) {
    bool valid = true;
    if (image->has_mean_background && image->header.splat_count > 0)
        return true;
    for (unsigned i = 0; i < gsf_channel_count(&image->header); i++)
        valid = valid && (image->header.high_bit_depth || image->background[i] <= 255);
    return valid;
}

static bool within(int value, int min, int max) {
    return value >= min && value <= max;
}

static bool steps_are_valid(const gsf_steps *steps) {
    return (steps->scale | steps->position | steps->angle | steps->luma | steps->chroma | steps->alpha |
            steps->opacity) <= 15 &&
           steps->pivot <= GSF_MAX_SCALE_CODE;
}

static bool shape_is_valid(const gsf_coded_image *image, const gsf_splat *splat) {
    const gsf_header *header = &image->header;
    const gsf_steps *steps = &image->steps;
    if (splat->layer > header->enhancement_layers || splat->major > GSF_MAX_SCALE_CODE ||
        (header->has_anisotropy && splat->aspect > splat->major) ||
        (header->has_rotation && splat->angle >= gsf_angle_count(steps, splat->aspect)))
        return false;
    const gsf_splat_grid grid = gsf_splat_grid_of(header, steps, splat);
    return splat->x < grid.cells_x && splat->y < grid.cells_y;
}

static bool texture_is_valid(const gsf_texture *texture) {
    if (texture->amplitude == 0)
        return (texture->wave | texture->direction | texture->phase) == 0;
    return texture->amplitude <= GSF_AMPLITUDES && texture->wave < GSF_WAVES && texture->direction < GSF_DIRECTIONS &&
           texture->phase < GSF_PHASES;
}

static bool colour_is_valid(const gsf_coded_image *image, const gsf_splat *splat) {
    const gsf_header *header = &image->header;
    const unsigned fineness = gsf_colour_fineness(&image->steps, splat->major, splat->aspect);
    int min, max;
    gsf_luma_range(header->blend, image->steps.luma, fineness, &min, &max);
    bool valid = within(splat->luma, min, max);
    gsf_luma_range(header->blend, image->steps.alpha, 1, &min, &max);
    valid = valid && (!header->has_alpha || within(splat->alpha, min, max));
    gsf_chroma_range(image->steps.chroma, fineness, &min, &max);
    valid = valid && (!header->has_chroma || (within(splat->co, min, max) && within(splat->cg, min, max)));
    valid = valid && (!header->has_opacity || splat->opacity <= image->steps.opacity);
    return valid && (!header->has_texture || texture_is_valid(&splat->texture));
}

static bool scalar_is_valid(const gsf_coded_image *image) {
    bool valid = steps_are_valid(&image->steps);
    for (uint32_t i = 0; valid && i < image->header.splat_count; i++)
        valid = shape_is_valid(image, &image->splats[i]) && colour_is_valid(image, &image->splats[i]) &&
                gsf_packet_may_hold(image, i, image->header.packets, image->header.packet);
    return valid;
}

static bool indexed_is_valid(const gsf_coded_image *image) {
    const gsf_codebooks *books = &image->codebooks;
    if (!gsf_codebook_parameters_are_valid(&image->header, books) ||
        !gsf_codebook_words_are_valid(&image->header, books))
        return false;
    bool valid = true;
    for (uint32_t i = 0; valid && i < image->header.splat_count; i++) {
        const gsf_indexed_splat *splat = &image->indexed[i];
        valid = splat->shape < books->shape_count && splat->colour < books->colour_count &&
                splat->x >> books->position_bits == 0 && splat->y >> books->position_bits == 0;
    }
    return valid;
}

bool gsf_coded_image_is_valid(const gsf_coded_image *image) {
    if (!gsf_header_is_valid(&image->header) || !background_is_valid(image) ||
        (image->header.packets > 0 && image->identity == GSF_NO_IDENTITY) ||
        (image->bare || image->header.packets > 0 ? image->blocks != NULL : !gsf_blocks_are_valid(image->blocks)))
        return false;
    if (image->header.splat_count == 0)
        return true;
    return image->header.coding == GSF_CODING_SCALAR ? scalar_is_valid(image) : indexed_is_valid(image);
}
