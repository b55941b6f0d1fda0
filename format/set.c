#include "format/set.h"

#include "format/count_split.h"

/* Tuning: part of the format.  Splats cluster over the image, but not within a few of their own
 * widths: there only areas count. */
enum {
    CLASS_WEIGHT = 2 * GSF_URN_UNIT, /* for every class */
    WIDE = 128,                      /* cells: a rectangle longer than that is wide */
    WIDE_WEIGHT = 3 * GSF_URN_UNIT,  /* shared by the halves of a wide rectangle by area, and ... */
    PRIOR_WEIGHT = GSF_URN_UNIT / 4, /* ... for each prior splat in a half */
    NARROW_WEIGHT = 16 * GSF_URN_UNIT
};

/* Most pictures leave classes at both ends empty. */
static void code_class_range(gsf_coder *coder, const uint32_t *counts, uint32_t classes, uint32_t *first,
                             uint32_t *last) {
    *first = 0;
    *last = classes - 1;
    if (!coder->decoding) {
        while (counts[*first] == 0)
            ++*first;
        while (counts[*last] == 0)
            --*last;
    }
    *first = gsf_code_uniform(coder, *first, classes);
    *last = *first + gsf_code_uniform(coder, *last - *first, classes - *first);
}

static uint32_t sum(const uint32_t *counts, uint32_t n) {
    uint32_t total = 0;
    for (uint32_t i = 0; i < n; i++)
        total += counts[i];
    return total;
}

/* Halves the range of classes until single classes are left: at most 10 deep. */
static void code_counts(gsf_coder *coder, uint32_t *counts, uint32_t classes, uint32_t n) {
    if (classes == 1 || n == 0) {
        for (uint32_t i = 0; i < classes; i++)
            counts[i] = i == 0 ? n : 0;
        return;
    }
    const uint32_t half = classes / 2;
    const uint32_t left = gsf_code_urn(coder, coder->decoding ? 0 : sum(counts, half), n, half * CLASS_WEIGHT,
                                       (classes - half) * CLASS_WEIGHT);
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
    /* No branch on which half it is, nor on which is longer: it would be guessed wrong. */
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
    return rect.width > WIDE || rect.height > WIDE;
}

/* A grid has at most 2^19 x 2^19 cells, and each of 38 splits leaves one half waiting. */
#define MAX_DEPTH 40

/* Points in stored order have those of the first half in front. */
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

/* What the encoder knows and the decoder is told. */
static uint32_t known_left(const gsf_coder *coder, const gsf_point *points, uint32_t n, const gsf_split *split) {
    return coder->decoding ? 0 : count_left(points, n, split);
}

/* Brings the priors of the first half to the front and returns their number. */
static uint32_t partition(gsf_prior *list, uint32_t n, const gsf_split *split, const gsf_grid *grid) {
    const uint32_t bound = 2 * split->at * (split->along_x ? grid->pitch_x : grid->pitch_y);
    uint32_t left = 0;
    for (uint32_t i = 0; i < n; i++) {
        /* No branch that half of the priors would send the wrong way: what does not belong changes places, too. */
        const gsf_prior prior = list[i];
        list[i] = list[left];
        list[left] = prior;
        left += (split->along_x ? prior.x : prior.y) < bound;
    }
    return left;
}

/* The halves' shares, where a side of `length` cells is cut. */
static void share_by_area(uint32_t total, uint32_t length, uint32_t weight[2]) {
    weight[0] = total * (length / 2) / length;
    weight[1] = total - weight[0];
}

static void place(gsf_point *points, const node *leaf) {
    for (uint32_t i = 0; i < leaf->n; i++)
        points[leaf->first + i] = (gsf_point){leaf->rect.x, leaf->rect.y};
}

/* A class that is being coded. */
typedef struct task {
    const gsf_grid *grid;
    gsf_point *points;
    uint32_t n;
    gsf_prior *priors;
    uint32_t prior_n;
    const gsf_ball *narrow; /* by the side that is cut, of rectangles that are not wide */
} task;

/* The priors of a class: whole classes, going back from it for as long as they fit. */
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

static void weigh_narrow(uint32_t length, uint32_t weight[2]) {
    share_by_area(NARROW_WEIGHT, length, weight);
}

/* Returns the number of priors in the first half, and brings those to the front. */
static uint32_t weigh_wide(const task *t, const node *whole, const gsf_split *split, uint32_t weight[2]) {
    share_by_area(WIDE_WEIGHT, split->length, weight);
    const uint32_t near = partition(t->priors + whole->prior_first, whole->prior_n, split, t->grid);
    weight[0] += PRIOR_WEIGHT * near;
    weight[1] += PRIOR_WEIGHT * (whole->prior_n - near);
    return near;
}

/* Codes how one rectangle's points divide, and puts the halves that have points on the stack, the
 * first half on top.  Returns the stack's new depth. */
static unsigned code_split(gsf_coder *coder, const task *t, node *stack, unsigned depth) {
    const node whole = stack[--depth];
    const gsf_split split = gsf_split_rect(t->grid, whole.rect);
    uint32_t weight[2], near = 0;
    if (is_wide(whole.rect))
        near = weigh_wide(t, &whole, &split, weight);
    else
        weigh_narrow(split.length, weight);
    const uint32_t known = known_left(coder, t->points + whole.first, whole.n, &split);
    const uint32_t left = gsf_code_urn(coder, known, whole.n, weight[0], weight[1]);
    if (left < whole.n)
        stack[depth++] = (node){gsf_half(whole.rect, &split, true), whole.first + left, whole.n - left,
                                whole.prior_first + near, whole.prior_n - near};
    if (left > 0)
        stack[depth++] = (node){gsf_half(whole.rect, &split, false), whole.first, left, whole.prior_first, near};
    return depth;
}

/* The splits around a single point, which most splits are: as code_split, with one half to go on with. */
static void code_point(gsf_coder *coder, const task *t, node at) {
    gsf_point *point = &t->points[at.first];
    while (is_wide(at.rect)) {
        const gsf_split split = gsf_split_rect(t->grid, at.rect);
        uint32_t weight[2];
        const uint32_t near = weigh_wide(t, &at, &split, weight);
        const bool left =
            gsf_code_ball(coder, known_left(coder, point, 1, &split) != 0, gsf_ball_of(weight[0], weight[1]));
        at.rect = gsf_half(at.rect, &split, !left);
        at.prior_first += left ? 0 : near;
        at.prior_n = left ? near : at.prior_n - near;
    }
    gsf_rect rect = at.rect;
    while (rect.width > 1 || rect.height > 1) {
        const gsf_split split = gsf_split_rect(t->grid, rect);
        const bool left = gsf_code_ball(coder, known_left(coder, point, 1, &split) != 0, t->narrow[split.length]);
        rect = gsf_half(rect, &split, !left);
    }
    *point = (gsf_point){rect.x, rect.y};
}

static void code_class(gsf_coder *coder, const task *t) {
    node stack[MAX_DEPTH];
    unsigned depth = 1;
    stack[0] = (node){{0, 0, t->grid->cells_x, t->grid->cells_y}, 0, t->n, 0, t->prior_n};
    while (depth > 0 && !gsf_coder_starved(coder)) {
        const node *top = &stack[depth - 1];
        if (top->n == 1)
            code_point(coder, t, stack[--depth]);
        else if (top->rect.width > 1 || top->rect.height > 1)
            depth = code_split(coder, t, stack, depth);
        else
            place(t->points, &stack[--depth]);
    }
}

static void fill_narrow(gsf_ball narrow[WIDE + 1]) {
    for (uint32_t length = 2; length <= WIDE; length++) {
        uint32_t weight[2];
        weigh_narrow(length, weight);
        narrow[length] = gsf_ball_of(weight[0], weight[1]);
    }
}

void gsf_code_points(gsf_coder *coder, gsf_point *points, const uint32_t *counts, const gsf_grid *grids,
                     uint32_t classes, gsf_prior *priors) {
    gsf_ball narrow[WIDE + 1];
    fill_narrow(narrow);
    for (uint32_t i = 0; i < classes; i++) {
        if (counts[i] == 0)
            continue;
        const uint32_t prior_n = collect_priors(points, counts, grids, i, priors);
        const task t = {&grids[i], points, counts[i], priors, prior_n, narrow};
        code_class(coder, &t);
        points += counts[i];
    }
}
