/* How the work-items of a group share a splat in a rate-distortion pass.
 *
 * Build option RDO_ITEMS, the work-items of a group: 1 on CPUs, a power of 2 from 32 to 256 on GPUs.  There a pass over the
 * pixels of a splat has a team of them: all, or a part, so that several teams evaluate a splat each at once.  A team forms rows
 * of RDO_ITEMS_X work-items, which divide the rows of an outline and the pixel vectors of a row among themselves.  What all
 * decide by is in local memory or computed from it by each in the same way, so that all take the same decisions and meet at the
 * same barriers. */
#ifndef RDO_ITEMS
#define RDO_ITEMS 1
#endif
#if RDO_ITEMS > 1
#define RDO_ITEMS_X (RDO_ITEMS / 32) /* at most the work-items of a team */
#define RDO_ITEM ((int)get_local_id(0))
#define RDO_SYNCHRONISE() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#else
#define RDO_ITEMS_X 1
#define RDO_ITEM 0
#define RDO_SYNCHRONISE()
#endif

/* The work-items of a team, whole rows of them, where so many splats, less than MAX_TEAMS, are evaluated at once, and the number of
 * this one's.  The last work-items may be too few for a team: they take part in all, and nobody takes what they found. */
#define MAX_TEAMS 7
#define TEAM_OF(splats) (RDO_ITEMS > 1 ? RDO_ITEMS / (splats) / RDO_ITEMS_X * RDO_ITEMS_X : 1)
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
#define RDO_LOAD_WEIGHTS(p, lanes) pix_load_or(p, lanes, 1.0f)
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

/* Sums of all work-items that are added up at once, so that 256 work-items need less than 32 KiB of local memory. */
#define SUMS_AT_ONCE 28
#define SHARED_STRIDE (RDO_ITEMS + 1) /* so that work-items that read a column each use memory banks of their own */
#define ITEM_SUMS (SUMS_AT_ONCE * SHARED_STRIDE)
#define MAX_TEAM_SUMS (MAX_TEAMS * 9) /* of all teams together; holds MODEL_SUMS, too, at most 50 */
/* The numbers of a team's work-items are added up in so many equal shares, of 16 numbers and more, each by a work-item. */
#define MAX_SHARES 8
#define SHARES_OF(team) ((team) < 32 ? 1 : (team) < 16 * MAX_SHARES ? (team) / 16 : MAX_SHARES)
#define SUMS_SHARED (RDO_ITEMS > 1 ? ITEM_SUMS + MAX_TEAM_SUMS + SUMS_AT_ONCE * MAX_SHARES : 1)

#if RDO_ITEMS > 1
/* Adds up the numbers of each team's work-items, a row of `shared` for each of `count`.  The sums of a team follow each other, among
 * TOTALS_OF from number `first` on. */
ITEMS_INLINE void items_add(int first, int count, int team, __local float *shared) {
    const int sums = RDO_ITEMS / team * count, shares = SHARES_OF(team), numbers = team / shares;
    __local float *totals = shared + ITEM_SUMS + first, *shared_sums = shared + ITEM_SUMS + MAX_TEAM_SUMS;
    RDO_SYNCHRONISE(); /* all have read the planes and stored their numbers */
    for (int i = RDO_ITEM; i < sums * shares; i += RDO_ITEMS) {
        __local const float *row = shared + i % count * SHARED_STRIDE + i % sums / count * team + i / sums * numbers;
        float sum = 0.0f;
        for (int j = 0; j < numbers; j++) sum += row[j];
        shared_sums[i] = sum;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = RDO_ITEM; i < sums; i += RDO_ITEMS) {
        float sum = 0.0f;
        for (int j = 0; j < shares; j++) sum += shared_sums[i + j * sums];
        totals[i] = sum;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

/* totals[0 to count - 1]: the sums of a team's work-items.  `count` and `team` are constants, with which the loops are
 * unrolled: within a function they would be unrolled without them.  What is in local memory is read until the next barrier and
 * written after it, so that none is needed between two sums. */
#define ITEMS_SUM(sums, count, team, totals, shared)                                                                \
    do {                                                                                                            \
        ITEMS_SUM_FROM(0, LESSER(count, SUMS_AT_ONCE), sums, team, totals, shared);                                 \
        if ((count) > SUMS_AT_ONCE) ITEMS_SUM_FROM(SUMS_AT_ONCE, (count)-SUMS_AT_ONCE, sums, team, totals, shared); \
    } while (0)
#define ITEMS_SUM_FROM(first, count, sums, team, totals, shared)                                            \
    do {                                                                                                    \
        UNROLL                                                                                              \
        for (int k = 0; k < (count); k++) (shared)[k * SHARED_STRIDE + RDO_ITEM] = (sums)[(first) + k];     \
        items_add(first, count, team, shared);                                                              \
        UNROLL                                                                                              \
        for (int k = 0; k < (count); k++) (totals)[(first) + k] = TOTALS_OF(first, team, count, shared)[k]; \
    } while (0)
#define TOTALS_OF(first, team, count, shared) ((shared) + ITEM_SUMS + (first) + TEAM_NUMBER(team) * (count))
#else
#define ITEMS_SUM(sums, count, team, totals, shared) lanes_sum(sums, count, totals)
ALWAYS_INLINE void lanes_sum(const pix *sums, int count, float *totals) {
    UNROLL
    for (int k = 0; k < count; k++) totals[k] = pix_sum(sums[k]);
}
#endif

/* ---- Decisions ---- */

#if RDO_ITEMS > 1
/* Where something follows from the numbers of all work-items, each of some looks at those of a block, and then at the blocks. */
#define ITEM_BLOCK 16
#define ITEM_BLOCKS (RDO_ITEMS / ITEM_BLOCK)

/* Replaces *cost and *number by the least cost of `count` and the number that comes with it, the lowest of several. */
ITEMS_INLINE void take_least(__local const float *costs, __local const float *numbers, int count, float *cost,
                             float *number) {
    for (int i = 0; i < count; i++)
        if (costs[i] < *cost || (costs[i] == *cost && numbers[i] < *number)) {
            *cost = costs[i];
            *number = numbers[i];
        }
}
#endif

/* The least cost of all work-items; *number, at most 2^24, becomes the one that comes with it, the lowest of several. */
ITEMS_INLINE float items_least(float cost, int *number, __local float *shared) {
#if RDO_ITEMS > 1
    __local float *numbers = shared + RDO_ITEMS, *of_blocks = numbers + RDO_ITEMS;
    const int block = RDO_ITEM * ITEM_BLOCK;
    float found = (float)*number;
    shared[RDO_ITEM] = cost;
    numbers[RDO_ITEM] = found;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (RDO_ITEM < ITEM_BLOCKS) {
        take_least(shared + block, numbers + block, ITEM_BLOCK, &cost, &found);
        of_blocks[RDO_ITEM] = cost;
        of_blocks[ITEM_BLOCKS + RDO_ITEM] = found;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    take_least(of_blocks, of_blocks + ITEM_BLOCKS, ITEM_BLOCKS, &cost, &found);
    *number = (int)found;
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
    return cost;
}

#if RDO_ITEMS > 1
/* Numbers what all work-items have, in their order: the first number of this work-item, that of the next one, and
 * how many there are of all. */
ITEMS_INLINE int3 items_number(int count, __local float *shared) {
    __local float *of_blocks = shared + RDO_ITEMS;
    const int block = RDO_ITEM / ITEM_BLOCK;
    int3 numbers = (int3)(0);
    shared[RDO_ITEM] = as_float(count);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = block * ITEM_BLOCK; i < RDO_ITEM; i++) numbers.x += as_int(shared[i]);
    if (RDO_ITEM % ITEM_BLOCK == ITEM_BLOCK - 1) of_blocks[block] = as_float(numbers.x + count);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = 0; i < ITEM_BLOCKS; i++) {
        const int of_block = as_int(of_blocks[i]);
        numbers.x += i < block ? of_block : 0;
        numbers.z += of_block;
    }
    numbers.y = numbers.x + count;
    barrier(CLK_LOCAL_MEM_FENCE);
    return numbers;
}
#endif
