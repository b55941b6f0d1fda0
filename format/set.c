#include "format/set.h"

/* These weights are part of the format: FORMAT.md, "Set coding".  Splats cluster over an image, but not within a few of
 * their own widths, where the weights of a split follow the areas alone. */
enum {
    CLASS_WEIGHT = 2 * GSF_WEIGHT_UNIT,  /* for every class */
    WIDE_WEIGHT = 3 * GSF_WEIGHT_UNIT,   /* divided between the halves of a wide rectangle by area */
    PRIOR_WEIGHT = GSF_WEIGHT_UNIT / 4,  /* added to a half of a wide rectangle for each prior splat in it */
    NARROW_WEIGHT = 16 * GSF_WEIGHT_UNIT /* divided between the halves of any other rectangle by area */
};

/* Codes the first and the last class that has splats: most images leave classes at both ends empty. */
static void code_class_range(gsf_coder *coder, const uint32_t *counts, uint32_t classes, uint32_t *first,
                             uint32_t *last) {
    *first = 0;
    *last = classes - 1;
    if (!GSF_DECODING(coder)) {
        while (counts[*first] == 0)
            ++*first;
        while (counts[*last] == 0)
            --*last;
    }
    *first = gsf_code_uniform(coder, *first, classes);
    *last = *first + gsf_code_uniform(coder, *last - *first, classes - *first);
}

uint32_t gsf_sum(const uint32_t *counts, uint32_t n) {
    uint32_t total = 0;
    for (uint32_t i = 0; i < n; i++)
        total += counts[i];
    return total;
}

/* Halves the range of classes until single classes remain: at most 10 times. */
static void code_counts(gsf_coder *coder, uint32_t *counts, uint32_t classes, uint32_t n) {
    if (classes == 1 || n == 0) {
        for (uint32_t i = 0; i < classes; i++)
            counts[i] = i == 0 ? n : 0;
        return;
    }
    const uint32_t half = classes / 2;
    const uint32_t left = gsf_code_count_split(coder, GSF_DECODING(coder) ? 0 : gsf_sum(counts, half), n,
                                               half * CLASS_WEIGHT, (classes - half) * CLASS_WEIGHT);
    code_counts(coder, counts, half, left);
    code_counts(coder, counts + half, classes - half, n - left);
}

void gsf_code_class_counts(gsf_coder *coder, uint32_t *counts, uint32_t classes, uint32_t n) {
    uint32_t first, last;
    code_class_range(coder, counts, classes, &first, &last);
    for (uint32_t i = 0; i < classes; i++)
        if (i < first || i > last)
            counts[i] = 0;
    code_counts(coder, counts + first, last - first + 1, n);
}

gsf_split gsf_split_rect(const gsf_grid *grid, gsf_rect rect) {
    const uint64_t length_x = (uint64_t)rect.width * grid->pitch_x;
    const uint64_t length_y = (uint64_t)rect.height * grid->pitch_y;
    const bool along_x = rect.width > 1 && (rect.height == 1 || length_x >= length_y);
    const uint32_t length = along_x ? rect.width : rect.height, first = length / 2;
    return (gsf_split){along_x, length, first, (along_x ? rect.x : rect.y) + first};
}

gsf_rect gsf_half(gsf_rect rect, const gsf_split *split, bool second) {
    /* A branch on the half would be mispredicted. */
    const uint32_t skipped = split->first & (0 - (uint32_t)second);
    const uint32_t length = split->first + (split->length & (uint32_t)second);
    if (split->along_x) {
        rect.x += skipped;
        rect.width = length;
    } else {
        rect.y += skipped;
        rect.height = length;
    }
    return rect;
}

/* A rectangle still to be coded, with its part of the lists. */
typedef struct node {
    gsf_rect rect;
    uint32_t first, n; /* points */
    uint32_t prior_first, prior_n;
} node;

static bool is_wide(gsf_rect rect) {
    return rect.width > GSF_MAX_NARROW || rect.height > GSF_MAX_NARROW;
}

/* Nodes on the stack: a grid has at most 2^19 x 2^19 cells, and each of 38 splits leaves one half pending. */
#define MAX_DEPTH 40

/* In stored order the points of the first half come first. */
static uint32_t count_left(const gsf_point *points, uint32_t n, const gsf_split *split) {
    uint32_t low = 0, high = n;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if ((split->along_x ? points[middle].x : points[middle].y) < split->at)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The count to encode; unused when decoding. */
static uint32_t left_to_encode(const gsf_coder *coder, const gsf_point *points, uint32_t n, const gsf_split *split) {
    return GSF_DECODING(coder) ? 0 : count_left(points, n, split);
}

/* Moves the priors of the first half to the front and returns their number. */
static uint32_t partition(gsf_prior *list, uint32_t n, const gsf_split *split, const gsf_grid *grid) {
    const uint32_t bound = 2 * split->at * (split->along_x ? grid->pitch_x : grid->pitch_y);
    uint32_t left = 0;
    for (uint32_t i = 0; i < n; i++) {
        /* Swaps every prior, because a branch on its half would be mispredicted for half of them. */
        const gsf_prior prior = list[i];
        list[i] = list[left];
        list[left] = prior;
        left += (split->along_x ? prior.x : prior.y) < bound;
    }
    return left;
}

/* Divides a weight by area between the halves of a side of `length` cells. */
static void share_by_area(uint32_t total, uint32_t length, uint32_t weight[2]) {
    weight[0] = total * (length / 2) / length;
    weight[1] = total - weight[0];
}

static void place_points(gsf_point *points, const node *leaf) {
    for (uint32_t i = 0; i < leaf->n; i++)
        points[leaf->first + i] = (gsf_point){leaf->rect.x, leaf->rect.y};
}

/* The class that is coded now. */
typedef struct class_task {
    const gsf_grid *grid;
    gsf_point *points;
    uint32_t n;
    gsf_prior *priors;
    uint32_t prior_n;
    const gsf_single_split *narrow; /* for rectangles that are not wide, by the length of the side that is cut */
} class_task;

/* Lists the priors of a class: the splats of whole classes, from the class before it backwards while they fit. */
static uint32_t collect_priors(const gsf_point *points, const uint32_t *counts, const gsf_grid *grids,
                               uint32_t class_no, gsf_prior *priors) {
    uint32_t n = 0;
    while (class_no > 0 && n + counts[class_no - 1] <= GSF_MAX_PRIORS) {
        const gsf_grid *grid = &grids[--class_no];
        for (uint32_t i = 0; i < counts[class_no]; i++) {
            const gsf_point point = *--points;
            priors[n++] = (gsf_prior){(2 * point.x + 1) * grid->pitch_x, (2 * point.y + 1) * grid->pitch_y};
        }
    }
    return n;
}

static void narrow_weights(uint32_t length, uint32_t weight[2]) {
    share_by_area(NARROW_WEIGHT, length, weight);
}

/* Returns the number of priors in the first half and moves those to the front. */
static uint32_t wide_weights(const class_task *t, const node *whole, const gsf_split *split, uint32_t weight[2]) {
    share_by_area(WIDE_WEIGHT, split->length, weight);
    const uint32_t left_priors = partition(t->priors + whole->prior_first, whole->prior_n, split, t->grid);
    weight[0] += PRIOR_WEIGHT * left_priors;
    weight[1] += PRIOR_WEIGHT * (whole->prior_n - left_priors);
    return left_priors;
}

/* Codes the split of one rectangle's points, and puts the halves that have points on the stack, the first half on top.
 * Returns the new depth of the stack. */
static unsigned code_split(gsf_coder *coder, const class_task *t, node *stack, unsigned depth) {
    const node whole = stack[--depth];
    const gsf_split split = gsf_split_rect(t->grid, whole.rect);
    uint32_t weight[2], left_priors = 0;
    if (is_wide(whole.rect))
        left_priors = wide_weights(t, &whole, &split, weight);
    else
        narrow_weights(split.length, weight);
    const uint32_t known = left_to_encode(coder, t->points + whole.first, whole.n, &split);
    const uint32_t left = gsf_code_count_split(coder, known, whole.n, weight[0], weight[1]);
    if (left < whole.n)
        stack[depth++] = (node){gsf_half(whole.rect, &split, true), whole.first + left, whole.n - left,
                                whole.prior_first + left_priors, whole.prior_n - left_priors};
    if (left > 0)
        stack[depth++] = (node){gsf_half(whole.rect, &split, false), whole.first, left, whole.prior_first, left_priors};
    return depth;
}

/* Codes all splits down to the cell of a single point.  Most splits are of this kind. */
static void code_point(gsf_coder *coder, const class_task *t, node at) {
    gsf_point *point = &t->points[at.first];
    while (is_wide(at.rect)) {
        const gsf_split split = gsf_split_rect(t->grid, at.rect);
        uint32_t weight[2];
        const uint32_t left_priors = wide_weights(t, &at, &split, weight);
        const bool left = gsf_code_single_split(coder, left_to_encode(coder, point, 1, &split) != 0,
                                                gsf_single_split_of(weight[0], weight[1]));
        at.rect = gsf_half(at.rect, &split, !left);
        at.prior_first += left ? 0 : left_priors;
        at.prior_n = left ? left_priors : at.prior_n - left_priors;
    }
    gsf_rect rect = at.rect;
    while (rect.width > 1 || rect.height > 1) {
        const gsf_split split = gsf_split_rect(t->grid, rect);
        const bool left =
            gsf_code_single_split(coder, left_to_encode(coder, point, 1, &split) != 0, t->narrow[split.length]);
        rect = gsf_half(rect, &split, !left);
    }
    *point = (gsf_point){rect.x, rect.y};
}

static void code_class(gsf_coder *coder, const class_task *t) {
    node stack[MAX_DEPTH];
    unsigned depth = 1;
    stack[0] = (node){{0, 0, t->grid->cells_x, t->grid->cells_y}, 0, t->n, 0, t->prior_n};
    while (depth > 0 && !gsf_coder_overrun(coder)) {
        const node *top = &stack[depth - 1];
        if (top->n == 1 && !GSF_IS_SMALL)
            code_point(coder, t, stack[--depth]);
        else if (top->rect.width > 1 || top->rect.height > 1)
            depth = code_split(coder, t, stack, depth);
        else
            place_points(t->points, &stack[--depth]);
    }
}

void gsf_set_init(gsf_set *set, gsf_point *points, const uint32_t *counts, const gsf_grid *grids, gsf_prior *priors) {
    set->points = points;
    set->counts = counts;
    set->grids = grids;
    set->priors = priors;
    for (uint32_t length = 2; length <= GSF_MAX_NARROW && !GSF_IS_SMALL; length++) {
        uint32_t weight[2];
        narrow_weights(length, weight);
        set->narrow[length] = gsf_single_split_of(weight[0], weight[1]);
    }
}

void gsf_code_class_points(gsf_coder *coder, const gsf_set *set, uint32_t class_no, uint32_t first) {
    if (set->counts[class_no] == 0)
        return;
    gsf_point *points = set->points + first;
    const uint32_t prior_n = collect_priors(points, set->counts, set->grids, class_no, set->priors);
    const class_task t = {&set->grids[class_no], points, set->counts[class_no], set->priors, prior_n, set->narrow};
    code_class(coder, &t);
}
