#include "format/payload.h"

#include "format/check.h"
#include "format/codebooks.h"

static const gsf_model_shape COLOUR_INDEX = {16, 0, 1, {32, 4, 0}, 256};

/* Fills the class counts and the points from the splats (writer). */
static void list_splats(const gsf_coded_image *image, gsf_workspace *w) {
    for (uint32_t i = 0; i < GSF_MAX_CLASSES; i++)
        w->counts[i] = 0;
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        w->counts[gsf_class_of(image, i)]++;
        w->points[i] = image->header.coding == GSF_CODING_SCALAR
                           ? (gsf_point){image->splats[i].x, image->splats[i].y}
                           : (gsf_point){image->indexed[i].x, image->indexed[i].y};
    }
}

static void place_splat(gsf_coded_image *image, uint32_t splat, uint32_t class_no, gsf_point at) {
    if (image->header.coding == GSF_CODING_SCALAR)
        image->splats[splat] = (gsf_splat){.minor = (uint16_t)(GSF_MAX_SCALE_CODE - class_no), .x = at.x, .y = at.y};
    else
        image->indexed[splat] =
            (gsf_indexed_splat){.shape = (uint16_t)class_no, .x = (uint16_t)at.x, .y = (uint16_t)at.y};
}

/* Sets class and cell of the splats from the decoded lists (reader). */
static void place_splats(gsf_coded_image *image, const gsf_workspace *w) {
    uint32_t splat = 0;
    for (uint32_t i = 0; i < gsf_class_count(image); i++)
        for (uint32_t n = w->counts[i]; n > 0; n--, splat++)
            place_splat(image, splat, i, w->points[splat]);
}

/* Codes classes and positions. */
static void code_positions(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *w) {
    const uint32_t classes = gsf_class_count(image);
    const bool scalar = image->header.coding == GSF_CODING_SCALAR;
    if (!coder->decoding)
        list_splats(image, w);
    coder->stream = scalar ? GSF_STREAM_SCALE : GSF_STREAM_SHAPE_INDEX;
    gsf_code_class_counts(coder, w->counts, classes, image->header.splat_count);
    for (uint32_t i = 0; i < classes; i++)
        w->grids[i] = gsf_class_grid(image, i);
    coder->stream = GSF_STREAM_POSITION;
    gsf_code_points(coder, w->points, w->counts, w->grids, classes, w->priors);
    if (coder->decoding && !gsf_coder_overrun(coder))
        place_splats(image, w);
}

static void code_scalar(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *w) {
    gsf_attributes_init(&w->attributes, &image->header, &image->steps);
    for (uint32_t i = 0; i < image->header.splat_count && !gsf_coder_overrun(coder); i++)
        gsf_code_attributes(coder, &w->attributes, &image->splats[i]);
}

static void code_indexed(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *w) {
    coder->stream = GSF_STREAM_COLOUR_INDEX;
    gsf_model_init(&w->colour_index, &COLOUR_INDEX, image->codebooks.colour_count, 0);
    for (uint32_t i = 0; i < image->header.splat_count && !gsf_coder_overrun(coder); i++) {
        gsf_indexed_splat *splat = &image->indexed[i];
        splat->colour = (uint16_t)gsf_code_with_model(coder, splat->colour, &w->colour_index);
    }
}

/* Codes parameters and words of the codebooks. */
static bool code_codebooks(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *w) {
    coder->stream = GSF_STREAM_SIDE;
    if (!gsf_code_codebook_parameters(coder, &image->header, &image->codebooks))
        return false;
    coder->stream = GSF_STREAM_CODEBOOK;
    gsf_code_codebook_words(coder, &image->header, &image->codebooks, w->points);
    gsf_complete_shape_words(&image->header, &image->codebooks);
    return !gsf_coder_overrun(coder);
}

bool gsf_code_payload(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *workspace) {
    if (image->header.splat_count == 0)
        return true;
    if (image->header.coding == GSF_CODING_CODEBOOK && !code_codebooks(coder, image, workspace))
        return false;
    code_positions(coder, image, workspace);
    if (gsf_coder_overrun(coder))
        return false;
    if (image->header.coding == GSF_CODING_SCALAR)
        code_scalar(coder, image, workspace);
    else
        code_indexed(coder, image, workspace);
    return !gsf_coder_overrun(coder) && gsf_work_is_bounded(image);
}
