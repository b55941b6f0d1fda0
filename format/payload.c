#include "format/payload.h"

#include "format/check.h"
#include "format/codebooks.h"
#include "format/count_split.h"
#include "format/quantiser.h"
#include "format/tables.h"

static const gsf_model_shape COLOUR_INDEX = {16, 0, 1, {32, 4, 0}, 256};

/* Fills the class counts and the points from the splats (writer). */
static void list_splats(const gsf_coded_image *image, gsf_workspace *w) {
    for (uint32_t i = 0; i < gsf_class_count(image); i++)
        w->counts[i] = 0;
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        w->counts[gsf_class_of(image, i)]++;
        w->points[i] = gsf_class_point(image, i);
    }
}

static void place_splat(gsf_coded_image *image, uint32_t splat, uint32_t class_no, gsf_point point) {
    const gsf_point at = gsf_class_cell(image, class_no, point);
    if (image->header.coding == GSF_CODING_SCALAR)
        image->splats[splat] = (gsf_splat){
            .layer = class_no / GSF_SCALE_CLASSES, .major = (uint16_t)gsf_class_major(class_no), .x = at.x, .y = at.y};
    else
        image->indexed[splat] =
            (gsf_indexed_splat){.shape = (uint16_t)class_no, .x = (uint16_t)at.x, .y = (uint16_t)at.y};
}

/* Codes the number of splats in a class of scalar coding; `left` splats are in this class and those after it. */
static uint32_t code_class_count(gsf_coder *coder, uint32_t count, uint32_t left, uint32_t class_no, uint32_t typical) {
    const unsigned major = gsf_class_major(class_no);
    const uint16_t *weights = gsf_class_weight_table[gsf_size_row(major, typical, GSF_CLASS_BELOW, GSF_CLASS_ROWS)];
    return left == 0 || major == 0 ? left : gsf_code_count_split(coder, count, left, weights[0], weights[1]);
}

/* Codes the number of splats in a layer and in each of its classes, the first of which is `class_no`; `left` splats are
 * in this layer and those after it.  Returns the number in this layer. */
static uint32_t code_layer_counts(gsf_coder *coder, gsf_workspace *w, uint32_t class_no, uint32_t left, bool is_last) {
    uint32_t *counts = w->counts + class_no, n = left;
    gsf_coder_count_in(coder, GSF_STREAM_SCALE);
    if (left > 0 && !is_last)
        n = gsf_code_count_split(coder, gsf_sum(counts, GSF_SCALE_CLASSES), left, GSF_WEIGHT_UNIT, GSF_WEIGHT_UNIT);
    for (uint32_t i = 0, rest = n; i < GSF_SCALE_CLASSES; i++) {
        counts[i] = code_class_count(coder, counts[i], rest, class_no + i, w->models.attributes.typical_size);
        rest -= counts[i];
    }
    return n;
}

/* Classes whose counts are coded together: a layer, or all of codebook coding. */
static uint32_t group_size(const gsf_coded_image *image) {
    return image->header.coding == GSF_CODING_SCALAR ? GSF_SCALE_CLASSES : gsf_class_count(image);
}

/* Codes the counts of the group that begins with `class_no`; `left` splats are in it and those after it.  Returns the
 * number in it. */
static uint32_t code_group_counts(gsf_coder *coder, const gsf_coded_image *image, gsf_workspace *w, uint32_t class_no,
                                  uint32_t left) {
    const uint32_t group = group_size(image);
    if (image->header.coding == GSF_CODING_SCALAR)
        return code_layer_counts(coder, w, class_no, left, class_no + group == gsf_class_count(image));
    gsf_coder_count_in(coder, GSF_STREAM_SHAPE_INDEX);
    gsf_code_class_counts(coder, w->counts, group, left);
    return left;
}

static void code_indexed(gsf_coder *coder, gsf_workspace *w, gsf_indexed_splat *splat) {
    gsf_coder_count_in(coder, GSF_STREAM_COLOUR_INDEX);
    splat->colour = (uint16_t)gsf_code_with_model(coder, splat->colour, &w->models.colour_index.model);
}

/* Codes the positions of the splats of a class, then all else of each of them. */
static void code_class(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *w, uint32_t class_no, uint32_t first) {
    const uint32_t end = first + w->counts[class_no];
    gsf_coder_count_in(coder, GSF_STREAM_POSITION);
    gsf_code_class_points(coder, &w->set, class_no, first);
    for (uint32_t i = first; i < end && !gsf_coder_overrun(coder); i++) {
        if (GSF_DECODING(coder))
            place_splat(image, i, class_no, w->points[i]);
        if (image->header.coding == GSF_CODING_SCALAR)
            gsf_code_attributes(coder, &w->models.attributes, &image->splats[i]);
        else
            code_indexed(coder, w, &image->indexed[i]);
        if (gsf_coder_is_certain(coder))
            w->certain = i + 1;
    }
}

static void code_splats(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *w) {
    const uint32_t classes = gsf_class_count(image);
    uint32_t first = 0, left = image->header.splat_count;
    if (!GSF_DECODING(coder))
        list_splats(image, w);
    for (uint32_t i = 0; i < classes; i++)
        w->grids[i] = gsf_class_grid(image, i);
    gsf_set_init(&w->set, w->points, w->counts, w->grids, w->priors);
    if (image->header.coding == GSF_CODING_SCALAR)
        gsf_attributes_init(&w->models.attributes, &image->header, &image->steps);
    else
        gsf_model_init(&w->models.colour_index.model, &COLOUR_INDEX, w->models.colour_index.freq,
                       image->codebooks.colour_count, 0);
    for (uint32_t i = 0; i < classes && !gsf_coder_overrun(coder); i++) {
        if (i % group_size(image) == 0)
            left -= code_group_counts(coder, image, w, i, left);
        code_class(coder, image, w, i, first);
        first += w->counts[i];
    }
}

/* Codes parameters and words of the codebooks. */
static void code_codebooks(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *w) {
    gsf_coder_count_in(coder, GSF_STREAM_SIDE);
    gsf_code_codebook_parameters(coder, &image->header, &image->codebooks);
    gsf_coder_count_in(coder, GSF_STREAM_CODEBOOK);
    gsf_code_codebook_words(coder, &image->header, &image->codebooks, w->points);
    gsf_complete_shape_words(&image->header, &image->codebooks);
}

/* The most classes that a file with this header has: with codebooks their number is not known yet. */
static size_t class_rows(const gsf_header *header) {
    return header->coding == GSF_CODING_SCALAR ? GSF_SCALE_CLASSES * (header->enhancement_layers + (size_t)1)
                                               : GSF_MAX_CLASSES;
}

/* Rows of the list of points: splats, or the words of a codebook. */
static size_t point_rows(const gsf_header *header) {
    const bool has_words = header->coding == GSF_CODING_CODEBOOK && header->splat_count < GSF_MAX_CODEBOOK;
    return has_words ? GSF_MAX_CODEBOOK : header->splat_count;
}

size_t gsf_workspace_size(const gsf_header *header) {
    const size_t priors = header->splat_count < GSF_MAX_PRIORS ? header->splat_count : GSF_MAX_PRIORS;
    return sizeof(gsf_workspace) + class_rows(header) * (sizeof(gsf_grid) + sizeof(uint32_t)) +
           point_rows(header) * sizeof(gsf_point) + priors * sizeof(gsf_prior);
}

gsf_workspace *gsf_workspace_in(const gsf_header *header, void *memory) {
    gsf_workspace *workspace = memory;
    workspace->grids = (gsf_grid *)(workspace + 1);
    workspace->counts = (uint32_t *)(workspace->grids + class_rows(header));
    workspace->points = (gsf_point *)(workspace->counts + class_rows(header));
    workspace->priors = (gsf_prior *)(workspace->points + point_rows(header));
    return workspace;
}

bool gsf_code_payload(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *workspace) {
    workspace->certain = 0;
    if (image->header.splat_count == 0)
        return true;
    if (image->header.coding == GSF_CODING_CODEBOOK)
        code_codebooks(coder, image, workspace);
    if (!gsf_coder_overrun(coder))
        code_splats(coder, image, workspace);
    return !gsf_coder_overrun(coder) && gsf_work_is_bounded(image);
}
