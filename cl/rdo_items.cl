/* How the work-items of a group share a splat in a rate-distortion pass.
 *
 * Build option RDO_ITEMS, the work-items of a group.  1 on CPUs.  On GPUs they form RDO_ITEMS_Y rows of RDO_ITEMS_X
 * work-items, which divide the rows of an outline and the pixel vectors of a row among themselves.  Their sums go to all
 * of them, so that all take the same decisions. */
#ifndef RDO_ITEMS
#define RDO_ITEMS 1
#endif
#if RDO_ITEMS > 1
#define RDO_ITEMS_X 4
#define RDO_ITEM ((int)get_local_id(0))
#define RDO_SYNCHRONISE() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#else
#define RDO_ITEMS_X 1
#define RDO_ITEM 0
#define RDO_SYNCHRONISE()
#endif
#define RDO_ITEMS_Y (RDO_ITEMS / RDO_ITEMS_X)

/* The rows of an outline, and the pixel vectors from column `first` to `last`, of this work-item. */
#define FOR_ROWS(y, first, last) for (int y = (first) + RDO_ITEM / RDO_ITEMS_X; y <= (last); y += RDO_ITEMS_Y)
#define FOR_VECTORS(x, first, last) \
    for (int x = (first) + RDO_ITEM % RDO_ITEMS_X * LANES; x <= (last); x += RDO_ITEMS_X * LANES)

/* Loads a pixel vector of which `lanes` pixels are used.  Those behind may be other work-items' to change, and are loaded
 * as 0; sums of weights, by which others are divided, as 1. */
#if RDO_ITEMS > 1
#define RDO_LOAD(p, lanes) pix_load_clipped(p, lanes)
#define RDO_LOAD_WEIGHTS(p, lanes) (pix_load_clipped(p, lanes) + (1.0f - pix_inside(lanes)))
#else
#define RDO_LOAD(p, lanes) PIX_LOAD(p)
#define RDO_LOAD_WEIGHTS(p, lanes) PIX_LOAD(p)
#endif

/* For loops that index codes and the like: unrolled on GPUs, where an array stays in registers only if all its indices are
 * constants. */
#if RDO_ITEMS > 1
#define ITEMS_UNROLL UNROLL
#else
#define ITEMS_UNROLL
#endif

#define MAX_ITEM_SUMS 56
#define SHARED_STRIDE (RDO_ITEMS + 1) /* so that work-items that read a column each use memory banks of their own */
#define ITEM_SUMS (MAX_ITEM_SUMS * SHARED_STRIDE)
/* Candidates of a splat that work-items prepare, each one of its own, at most RDO_ITEMS; and floats of each. */
#define MAX_CANDIDATES 6
#define CANDIDATE (GSCL_PROJECTED + GSCL_BOUNDS)
/* Local memory of a group: sums, and behind them candidates. */
#define RDO_SHARED (RDO_ITEMS > 1 ? ITEM_SUMS + MAX_CANDIDATES * CANDIDATE : 1)

#if RDO_ITEMS > 1
/* Replaces each work-item's numbers, a row of `shared` for each of `count` at most MAX_ITEM_SUMS, by their sum in column 0. */
void items_add(int count, __local float *restrict shared) {
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int k = RDO_ITEM; k < count; k += RDO_ITEMS) {
        float sum = 0.0f;
        for (int j = 0; j < RDO_ITEMS; j++) sum += shared[k * SHARED_STRIDE + j];
        shared[k * SHARED_STRIDE] = sum;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

/* totals[0 to count - 1]: the sums of pixel vectors over all lanes and work-items.  `count` is a constant, with which the
 * loops are unrolled: within a function they would be unrolled without it. */
#define ITEMS_SUM(sums, count, totals, shared)                                                         \
    do {                                                                                               \
        UNROLL                                                                                         \
        for (int k = 0; k < (count); k++) (shared)[k * SHARED_STRIDE + RDO_ITEM] = pix_sum((sums)[k]); \
        items_add(count, shared);                                                                      \
        UNROLL                                                                                         \
        for (int k = 0; k < (count); k++) (totals)[k] = (shared)[k * SHARED_STRIDE];                   \
        barrier(CLK_LOCAL_MEM_FENCE);                                                                  \
    } while (0)
#else
#define ITEMS_SUM(sums, count, totals, shared) lanes_sum(sums, count, totals)
ALWAYS_INLINE void lanes_sum(const pix *sums, int count, float *totals) {
    UNROLL
    for (int k = 0; k < count; k++) totals[k] = pix_sum(sums[k]);
}
#endif

/* The number that comes with the least cost of all work-items, the lowest of several; at most 2^24. */
int items_least(float cost, int number, __local float *restrict shared) {
#if RDO_ITEMS > 1
    shared[RDO_ITEM] = cost;
    shared[RDO_ITEMS + RDO_ITEM] = (float)number;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int j = 0; j < RDO_ITEMS; j++) {
        float other = shared[j];
        int other_number = (int)shared[RDO_ITEMS + j];
        if (other < cost || (other == cost && other_number < number)) {
            cost = other;
            number = other_number;
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
    return number;
}

#if RDO_ITEMS > 1
/* Numbers what all work-items have, in their order: the first number of this work-item, that of the next one, and
 * how many there are of all. */
int3 items_number(int count, __local float *restrict shared) {
    int3 numbers = (int3)(0);
    shared[RDO_ITEM] = as_float(count);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int j = 0; j < RDO_ITEMS; j++) {
        if (j == RDO_ITEM) numbers.x = numbers.z;
        numbers.z += as_int(shared[j]);
        if (j == RDO_ITEM) numbers.y = numbers.z;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    return numbers;
}

/* Gives all work-items the number of one. */
float number_of_item(float own, int item, __local float *restrict shared) {
    if (RDO_ITEM == item) shared[0] = own;
    barrier(CLK_LOCAL_MEM_FENCE);
    float number = shared[0];
    barrier(CLK_LOCAL_MEM_FENCE);
    return number;
}
#endif
