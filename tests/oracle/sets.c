/* "Set coding": class counts and positions. */
#include <stdlib.h>

#include "parts.h"

#define MAX_PRIORS 4096

static void split_counts(oracle_decoder *decoder, uint32_t *counts, uint32_t classes, uint32_t n) {
    if (classes == 1) {
        counts[0] = n;
        return;
    }
    if (n == 0 || oracle_decoder_failed(decoder))
        return;
    const uint32_t half = classes / 2;
    const uint32_t left = oracle_count_split(decoder, n, half * 128, (classes - half) * 128);
    split_counts(decoder, counts, half, left);
    split_counts(decoder, counts + half, classes - half, n - left);
}

void oracle_class_counts(oracle_decoder *decoder, uint32_t classes, uint32_t n, uint32_t *counts) {
    for (uint32_t i = 0; i < classes; i++)
        counts[i] = 0;
    const uint32_t first = oracle_uniform(decoder, classes);
    const uint32_t last = first + oracle_uniform(decoder, classes - first);
    split_counts(decoder, counts + first, last - first + 1, n);
}

/* ---- Positions ---- */

typedef struct {
    uint64_t axis[2];
} place;

/* The destination of the points of a class, and the pitches of its grid. */
typedef struct {
    oracle_decoder *decoder;
    uint64_t pitch[2];
    oracle_cell *next;
} walk;

/* In cells; axis 0 is x. */
typedef struct {
    uint32_t start[2], size[2];
} rectangle;

/* Moves the priors below `border` to the front and returns their number. */
static uint32_t partition_priors(place *priors, uint32_t count, int axis, uint64_t border) {
    uint32_t below = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (priors[i].axis[axis] < border) {
            const place moved = priors[below];
            priors[below++] = priors[i];
            priors[i] = moved;
        }
    }
    return below;
}

static void points(walk *way, rectangle in, uint32_t n, place *priors, uint32_t prior_count) {
    if (n == 0 || oracle_decoder_failed(way->decoder))
        return;
    if (in.size[0] == 1 && in.size[1] == 1) {
        for (uint32_t i = 0; i < n; i++)
            *way->next++ = (oracle_cell){in.start[0], in.start[1]};
        return;
    }
    const bool along_x =
        in.size[0] > 1 && (in.size[1] == 1 || in.size[0] * way->pitch[0] >= in.size[1] * way->pitch[1]);
    const int axis = along_x ? 0 : 1;
    const uint64_t size = in.size[axis], half = size / 2;
    const bool wide = in.size[0] > 128 || in.size[1] > 128;

    uint64_t left_weight, right_weight;
    uint32_t below = 0;
    if (wide) {
        below = partition_priors(priors, prior_count, axis, 2 * (in.start[axis] + half) * way->pitch[axis]);
        left_weight = 192 * half / size;
        right_weight = 192 - left_weight;
        left_weight += 16 * (uint64_t)below;
        right_weight += 16 * (uint64_t)(prior_count - below);
    } else {
        left_weight = 1024 * half / size;
        right_weight = 1024 - left_weight;
        prior_count = 0;
    }
    const uint32_t left = oracle_count_split(way->decoder, n, left_weight, right_weight);

    rectangle first = in, second = in;
    first.size[axis] = (uint32_t)half;
    second.start[axis] += (uint32_t)half;
    second.size[axis] -= (uint32_t)half;
    points(way, first, left, priors, below);
    points(way, second, n - left, priors + below, prior_count - below);
}

static void class_points(oracle_decoder *decoder, const oracle_grid *grid, uint32_t n, oracle_cell *cells,
                         place *priors, uint32_t prior_count) {
    walk way = {decoder, {grid->pitch_x, grid->pitch_y}, cells};
    const rectangle all = {{0, 0}, {grid->cells_x, grid->cells_y}};
    points(&way, all, n, priors, prior_count);
}

void oracle_points(oracle_decoder *decoder, const oracle_grid *grid, uint32_t n, oracle_cell *cells) {
    class_points(decoder, grid, n, cells, NULL, 0);
}

/* Lists the splats of the classes before this one, the nearest class first.  `end` is the first cell of this class. */
static uint32_t list_priors(uint32_t class, const uint32_t *counts, const oracle_grid *grids, const oracle_cell *end,
                            place *priors) {
    uint32_t listed = 0;
    while (class -- > 0) {
        if (listed + counts[class] > MAX_PRIORS)
            break;
        for (uint32_t i = 0; i < counts[class]; i++) {
            end--;
            priors[listed++] = (place){
                {(2 * (uint64_t)end->x + 1) * grids[class].pitch_x, (2 * (uint64_t)end->y + 1) * grids[class].pitch_y}};
        }
    }
    return listed;
}

bool oracle_positions(oracle_decoder *decoder, uint32_t classes, const uint32_t *counts, const oracle_grid *grids,
                      oracle_cell *cells) {
    place *priors = malloc(MAX_PRIORS * sizeof *priors);
    if (!priors)
        return false;
    for (uint32_t class = 0; class < classes && !oracle_decoder_failed(decoder); class ++) {
        if (counts[class] == 0)
            continue;
        const uint32_t prior_count = list_priors(class, counts, grids, cells, priors);
        class_points(decoder, &grids[class], counts[class], cells, priors, prior_count);
        cells += counts[class];
    }
    free(priors);
    return true;
}
