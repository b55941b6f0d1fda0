#include "codebook/codebook_order.h"

#include <math.h>
#include <string.h>

#include "cl/constants.h"
#include "codebook/codebook_quantise.h"

static const float pi = 3.14159265f;

/* Gives every word s1 >= s2.  The moments of a swapped word stay as they are: few words are swapped. */
static void order_axes(gscl_book *shapes) {
    for (int k = 0; k < shapes->count; k++) {
        float *w = shapes->words + k * GSCL_BOOK_DIMS;
        if (w[0] < w[1]) {
            const float t = w[0];
            w[0] = w[1];
            w[1] = t;
            w[2] += pi / 2;
        }
        w[2] -= pi * floorf(w[2] / pi);
    }
}

/* Puts the host copies into the order `c->order`. */
static void reorder_host_copies(gscl_codebook *c) {
    const size_t n = gscl_codebook_splats(c);
    for (size_t i = 0; i < n; i++) {
        memcpy(c->sorted_params + i * GSCL_PARAMS, c->params + c->order[i] * GSCL_PARAMS, GSCL_PARAMS * sizeof(float));
        memcpy(c->sorted_pairs[i], c->pairs[c->order[i]], sizeof c->sorted_pairs[i]);
    }
    memcpy(c->params, c->sorted_params, n * GSCL_PARAMS * sizeof(float));
    memcpy(c->pairs, c->sorted_pairs, n * sizeof *c->pairs);
}

gscl_result gscl_codebook_sort(gscl_codebook *c, gscl_coded_image *coded) {
    GSCL_TRY(gscl_codebook_read_back(c));
    order_axes(&c->books[GSCL_BOOK_SHAPE]);
    GSCL_TRY(gscl_codebook_quantise(c, coded));
    GSCL_TRY(gscl_coded_image_sort(coded, c->order));
    reorder_host_copies(c);
    GSCL_TRY(gscl_fit_reorder(c->fit, c->order, gscl_codebook_splats(c)));
    return gscl_codebook_upload(c);
}
