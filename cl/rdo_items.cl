/* How the work-items of a group share a splat in a rate-distortion pass.
 *
 * Build option RDO_ITEMS, the work-items of a group.  1 on CPUs.  On GPUs a pass over the pixels of a splat has a team of
 * them: all, or a part, so that several teams evaluate a splat each at once.  A team forms rows of RDO_ITEMS_X work-items,
 * which divide the rows of an outline and the pixel vectors of a row among themselves.  What all decide by is in local memory
 * or computed from it by each in the same way, so that all take the same decisions and meet at the same barriers. */
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

/* The work-items of a team where so many splats, at most MAX_TEAMS, are evaluated at once, and the number of this one's. */
#define MAX_TEAMS 8
#define TEAM_OF(splats) (RDO_ITEMS > 1 ? RDO_ITEMS / ((splats) > 4 ? 8 : 4) : 1)
#define TEAM_NUMBER(team) (RDO_ITEM / (team))

/* The rows of an outline, and the pixel vectors from column `first` to `last`, of this work-item of a team. */
#define FOR_ROWS(team, y, first, last) \
    for (int y = (first) + RDO_ITEM % (team) / RDO_ITEMS_X; y <= (last); y += (team) / RDO_ITEMS_X)
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
 * constants.  For functions that take such arrays: inlined there, because a call would pass them through memory. */
#if RDO_ITEMS > 1
#define ITEMS_UNROLL UNROLL
#define ITEMS_INLINE ALWAYS_INLINE
#else
#define ITEMS_UNROLL
#define ITEMS_INLINE
#endif

/* ---- Sums ---- */

/* A sum over pixel vectors: a number on GPUs, whose registers do not hold the vectors of all sums. */
#if RDO_ITEMS > 1
typedef float item_sum;
#if LANES == 4
#define ADD_PRODUCTS(a, b, sum) products_add(a, b, sum)
ALWAYS_INLINE float products_add(pix a, pix b, float sum) {
    return fma(a.s3, b.s3, fma(a.s2, b.s2, fma(a.s1, b.s1, fma(a.s0, b.s0, sum))));
}
#else
#define ADD_PRODUCTS(a, b, sum) ((sum) + pix_sum((a) * (b)))
#endif
#define ADD_LANES(a, sum) ((sum) + pix_sum(a))
#else
typedef pix item_sum;
#define ADD_PRODUCTS(a, b, sum) fma(a, b, sum)
#define ADD_LANES(a, sum) ((sum) + (a))
#endif

#define MAX_ITEM_SUMS 56
#define SHARED_STRIDE (RDO_ITEMS + 1) /* so that work-items that read a column each use memory banks of their own */
#define ITEM_SUMS (MAX_ITEM_SUMS * SHARED_STRIDE)
#define MAX_TEAM_SUMS (MAX_TEAMS * 9) /* of all teams together */
#define SUMS_SHARED (RDO_ITEMS > 1 ? ITEM_SUMS + (MAX_ITEM_SUMS > MAX_TEAM_SUMS ? MAX_ITEM_SUMS : MAX_TEAM_SUMS) : 1)

#if RDO_ITEMS > 1
/* Adds up the numbers of each team's work-items, a row of `shared` for each of `count` at most MAX_ITEM_SUMS.  The sums of
 * a team follow each other, behind the rows. */
ITEMS_INLINE void items_add(int count, int team, __local float *shared) {
    const int teams = RDO_ITEMS / team;
    RDO_SYNCHRONISE(); /* all have read the planes and stored their numbers */
    for (int i = RDO_ITEM; i < count * teams; i += RDO_ITEMS) {
        __local const float *row = shared + i / teams * SHARED_STRIDE + i % teams * team;
        float sum = 0.0f;
        for (int j = 0; j < team; j++) sum += row[j];
        shared[ITEM_SUMS + i % teams * count + i / teams] = sum;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

/* totals[0 to count - 1]: the sums of a team's work-items.  `count` and `team` are constants, with which the loops are
 * unrolled: within a function they would be unrolled without them.  What is in local memory is read until the next barrier and
 * written after it, so that none is needed between two sums. */
#define ITEMS_SUM(sums, count, team, totals, shared)                                                           \
    do {                                                                                                       \
        UNROLL                                                                                                 \
        for (int k = 0; k < (count); k++) (shared)[k * SHARED_STRIDE + RDO_ITEM] = (sums)[k];                  \
        items_add(count, team, shared);                                                                        \
        UNROLL                                                                                                 \
        for (int k = 0; k < (count); k++) (totals)[k] = (shared)[ITEM_SUMS + TEAM_NUMBER(team) * (count) + k]; \
    } while (0)
#else
#define ITEMS_SUM(sums, count, team, totals, shared) lanes_sum(sums, count, totals)
ALWAYS_INLINE void lanes_sum(const pix *sums, int count, float *totals) {
    UNROLL
    for (int k = 0; k < count; k++) totals[k] = pix_sum(sums[k]);
}
#endif

/* ---- Decisions ---- */

/* The number that comes with the least cost of all work-items, the lowest of several; at most 2^24. */
ITEMS_INLINE int items_least(float cost, int number, __local float *shared) {
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
ITEMS_INLINE int3 items_number(int count, __local float *shared) {
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
#endif
