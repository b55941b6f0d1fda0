/* Placing splats on a level of the pyramid: a density of each pixel, and systematic samples of it (fit/placement.h). */

/* ---- Densities ---- */

/* The magnitude of the gradient of the planes at a pixel: differences of its neighbours, over all channels. */
float edge_strength_at(__global const float *restrict planes, gscl_placement_settings t, int x, int y) {
    const int left = max(x - 1, 0), right = min(x + 1, t.width - 1);
    const int above = max(y - 1, 0), below = min(y + 1, t.height - 1);
    float sum = 0.0f;
    for (int k = 0; k < t.channels; k++, planes += (size_t)t.width * t.height) {
        float by_x = planes[(size_t)y * t.width + right] - planes[(size_t)y * t.width + left];
        float by_y = planes[(size_t)below * t.width + x] - planes[(size_t)above * t.width + x];
        sum = fma(by_x, by_x, fma(by_y, by_y, sum));
    }
    return sqrt(sum);
}

__kernel GROUP_OF(GSCL_IMAGE_GROUP) void edge_strength(__global const float *restrict planes, gscl_placement_settings t,
                                                       __global float *restrict strength) {
    int i = (int)get_global_id(0);
    if (i < t.width * t.height) strength[i] = edge_strength_at(planes, t, i % t.width, i / t.width);
}

/* What a pixel counts in a box sum: its value, or 1 where it is not 0. */
float counted(float value, int flags) { return flags == 0 ? value : value != 0.0f ? 1.0f : 0.0f; }

/* Sums of the values at most `radius` places away in a line of `count`, `stride` apart, from place `first` on.  They are at
 * least 0, as the values are, whatever is lost by rounding. */
void sum_windows(__global const float *restrict from, int stride, int count, int radius, int first, int flags,
                 __global float *restrict to) {
    const int end = min(first + GSCL_BOX_LENGTH, count);
    float sum = 0.0f;
    for (int i = max(first - radius, 0); i < min(first + radius, count); i++)
        sum += counted(from[(size_t)i * stride], flags);
    for (int i = first; i < end; i++) {
        if (i + radius < count) sum += counted(from[(size_t)(i + radius) * stride], flags);
        to[(size_t)i * stride] = fmax(sum, 0.0f);
        if (i - radius >= 0) sum -= counted(from[(size_t)(i - radius) * stride], flags);
    }
}

/* Sums over rows, of GSCL_BOX_LENGTH pixels a work-item.  `flags`: counts the values that are not 0. */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void box_rows(__global const float *restrict from, gscl_placement_settings t,
                                                  int radius, int flags, __global float *restrict to) {
    const int parts = (t.width + GSCL_BOX_LENGTH - 1) / GSCL_BOX_LENGTH;
    const int item = (int)get_global_id(0), y = item / parts;
    if (y >= t.height) return;
    const size_t row = (size_t)y * t.width;
    sum_windows(from + row, 1, t.width, radius, item % parts * GSCL_BOX_LENGTH, flags, to + row);
}

/* Sums over columns, likewise. */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void box_columns(__global const float *restrict from, gscl_placement_settings t,
                                                     int radius, __global float *restrict to) {
    const int item = (int)get_global_id(0), x = item % t.width, first = item / t.width * GSCL_BOX_LENGTH;
    if (first < t.height) sum_windows(from + x, t.width, t.height, radius, first, 0, to + x);
}

/* Whether a pixel has the colour of a flat background. */
bool matches_background(__global const float *restrict planes, __global const float *restrict background,
                        gscl_placement_settings t, int i) {
    for (int k = 0; k < t.channels; k++)
        if (fabs(planes[(size_t)k * t.width * t.height + i] - background[k]) > t.tolerance) return false;
    return true;
}

/* The density of the first splats: half of them follow edges, half are spread evenly, but for a flat background away from
 * edges, where they would cost time without any gain.  `total`: the strength of all edges.  `density` has, where there is
 * such a background, the number of pixels nearby at edges. */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void seed_density(__global const float *restrict planes,
                                                      __global const float *restrict background,
                                                      gscl_placement_settings t, __global const float *restrict total,
                                                      __global float *restrict density) {
    int i = (int)get_global_id(0), pixels = t.width * t.height;
    if (i >= pixels) return;
    bool needs_splats = t.has_background == 0 || density[i] > 0.0f || !matches_background(planes, background, t, i);
    float even = needs_splats ? *total / (float)pixels : 0.0f;
    density[i] = edge_strength_at(planes, t, i % t.width, i / t.width) + even;
}

/* ---- Samples ----
 *
 * The level is cut into strips of t.strip rows, which are walked to and fro, column by column. */

/* The first row of the strip of a column of the walk, and the column's place in it. */
int2 column_at(gscl_placement_settings t, int column) {
    const int strip = column / t.width, x = column % t.width;
    return (int2)(strip % 2 ? t.width - 1 - x : x, strip * t.strip);
}

/* The density of a pixel as a whole number, so that its sums are exact: 2^51 for the total of densities before box sums. */
ulong weight_at(__global const float *restrict density, gscl_placement_settings t, float total, int x, int y) {
    const float value = density[(size_t)y * t.width + x] * t.density_scale;
    return total > 0.0f ? (ulong)(fmin(fmax(value / total, 0.0f), 2.0f) * 0x1p51f) : 1ul;
}

ulong column_weight(__global const float *restrict density, gscl_placement_settings t, float total, int column) {
    const int2 at = column_at(t, column);
    const int end = min(at.y + t.strip, t.height);
    ulong sum = 0;
    for (int y = at.y; y < end; y++) sum += weight_at(density, t, total, at.x, y);
    return sum;
}

/* The columns of a work-item: its share in the GSCL_COLUMNS_OF_GROUP of group `group`. */
int2 own_columns(size_t group, gscl_placement_settings t) {
    const int share = GSCL_COLUMNS_OF_GROUP / (int)get_local_size(0);
    const int first = (int)group * GSCL_COLUMNS_OF_GROUP + (int)get_local_id(0) * share;
    return (int2)(min(first, t.columns), min(first + share, t.columns));
}

/* Weights of columns, and of all columns of each work-group. */
__kernel GROUP_OF(SUM_ITEMS) void weigh_columns(__global const float *restrict density, gscl_placement_settings t,
                                                __global const float *restrict total, __global ulong *restrict weights,
                                                __global ulong *restrict group_weights) {
    __local long sums[GSCL_SUM_ITEMS];
    const int2 own = own_columns(get_group_id(0), t);
    const int items = (int)get_local_size(0);
    ulong sum = 0;
    for (int i = own.x; i < own.y; i++) sum += weights[i] = column_weight(density, t, *total, i);
    group_scan((long)sum, items, sums);
    if (get_local_id(0) == 0) group_weights[get_group_id(0)] = (ulong)sums[items - 1];
}

/* Adds to the weight of each column those before it in the walk. */
__kernel GROUP_OF(SUM_ITEMS) void add_columns(gscl_placement_settings t, __global const ulong *restrict group_weights,
                                              __global ulong *restrict weights) {
    __local long sums[GSCL_SUM_ITEMS];
    const int2 own = own_columns(get_group_id(0), t);
    const int items = (int)get_local_size(0);
    ulong before = 0, sum = 0;
    for (int i = (int)get_local_id(0); i < (int)get_group_id(0); i += items) before += group_weights[i];
    group_scan((long)before, items, sums);
    before = (ulong)sums[items - 1];
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = own.x; i < own.y; i++) sum += weights[i];
    before += (ulong)group_scan((long)sum, items, sums) - sum;
    for (int i = own.x; i < own.y; i++) weights[i] = before += weights[i];
}

/* The state of the random generator for draw `draw` of new splat i. */
ulong random_state(ulong seed, int i, int draw) {
    return seed + (GSCL_PLACEMENT_DRAWS * (ulong)i + (ulong)draw + 1) * GSCL_RANDOM_STEP;
}

/* The column of the walk in which the cumulative weight passes `value`. */
int find_column(__global const ulong *restrict weights, int columns, ulong value) {
    int low = 0, high = columns - 1;
    while (low < high) {
        int mid = low + (high - low) / 2;
        if (weights[mid] > value) high = mid;
        else low = mid + 1;
    }
    return low;
}

/* The pixel of sample i: random within its part of the density. */
int2 sample_pixel(__global const float *restrict density, gscl_placement_settings t, float total,
                  __global const ulong *restrict weights, int i, ulong random) {
    const ulong part = weights[t.columns - 1] / (ulong)t.count;
    const ulong value = part * (ulong)i + (part >> 24) * random + (((part & 0xfffffful) * random) >> 24);
    const int column = find_column(weights, t.columns, value);
    int2 at = column_at(t, column);
    const int last = min(at.y + t.strip, t.height) - 1;
    ulong sum = column > 0 ? weights[column - 1] : 0;
    for (; at.y < last; at.y++) {
        sum += weight_at(density, t, total, at.x, at.y);
        if (sum > value) break;
    }
    return at;
}

/* The distance between samples where the density is that of this pixel: pixels of the level. */
float sample_distance(__global const float *restrict density, gscl_placement_settings t, float total, ulong all_weights,
                      int2 at) {
    const ulong weight = weight_at(density, t, total, at.x, at.y);
    return weight > 0 ? sqrt((float)all_weights / ((float)weight * (float)t.count)) : (float)(t.width + t.height);
}

/* ---- Splats ---- */

/* Adds a share of the structure tensor of the pixels around a pixel: sums of the products of the derivatives in x and y, over
 * all channels. */
void add_tensor(__global const float *restrict planes, gscl_placement_settings t, int2 at, int radius, int share,
                float *tensor) {
    const int side = 2 * radius + 1;
    for (int i = share; i < side * side; i += GSCL_SUM_ITEMS) {
        const int x = at.x - radius + i % side, y = at.y - radius + i / side;
        if (x < 1 || y < 1 || x > t.width - 2 || y > t.height - 2) continue;
        for (int k = 0; k < t.channels; k++) {
            __global const float *p = planes + ((size_t)k * t.height + y) * t.width + x;
            float by_x = p[1] - p[-1], by_y = p[t.width] - p[-t.width];
            tensor[0] = fma(by_x, by_x, tensor[0]);
            tensor[1] = fma(by_y, by_y, tensor[1]);
            tensor[2] = fma(by_x, by_y, tensor[2]);
        }
    }
}

/* Turns a circular splat along the edge below it and stretches it, by the coherence of the structure tensor: 1 at a straight
 * edge, 0 where no direction prevails. */
void follow_edge(gscl_placement_settings t, const float *tensor, __global float *restrict params) {
    const float across = tensor[0] - tensor[1], along = 2.0f * tensor[2];
    const float coherence = sqrt(across * across + along * along) / (tensor[0] + tensor[1] + t.min_edge);
    const float stretch = t.edge_stretch * coherence;
    params[GSCL_THETA] = 0.5f * atan2(along, across) + 1.57079633f;
    params[GSCL_LOG_S1] += stretch;
    params[GSCL_LOG_S2] = fmax(params[GSCL_LOG_S2] - stretch, log(t.min_axis));
}

/* Makes the new splats, a work-group each: at a random point of its pixel, with the pixel's colour.  Where splats have an
 * angle it lies along the edge at the pixel, if there is one, and is elongated. */
__kernel GROUP_OF(SUM_ITEMS) void place_splats(__global const float *restrict planes,
                                               __global const float *restrict density, gscl_placement_settings t,
                                               __global const float *restrict total,
                                               __global const ulong *restrict weights, ulong seed,
                                               __global float *restrict params) {
    __local float sums[3 * GSCL_SUM_ITEMS];
    __local int pixel; /* of the level */
    const int i = (int)get_group_id(0), item = (int)get_local_id(0);
    if (item == 0) {
        const int2 sample = sample_pixel(density, t, *total, weights, i, gscl_random_bits_of(random_state(seed, i, 0)));
        pixel = sample.y * t.width + sample.x;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const int2 at = (int2)(pixel % t.width, pixel / t.width);
    const float distance = sample_distance(density, t, *total, weights[t.columns - 1], at);
    const float sigma = fmax(t.axis * fmin(fmax(distance, t.least_distance), t.most_distance), t.min_axis);
    float tensor[3] = {0.0f, 0.0f, 0.0f};
    if (t.is_rotated != 0) {
        const float radius = fmin(fmax(sigma / t.scale, 1.0f), (float)t.max_edge_radius);
        FOR_SHARES(j) {
            float own[3] = {0.0f, 0.0f, 0.0f};
            add_tensor(planes, t, at, (int)radius, j, own);
            for (int k = 0; k < 3; k++) sums[k * GSCL_SUM_ITEMS + j] = own[k];
        }
        shares_sum(3, sums);
        for (int k = 0; k < 3; k++) tensor[k] = sums[k * GSCL_SUM_ITEMS];
    }
    if (item > 0) return;
    params += ((size_t)t.first + i) * GSCL_PARAMS;
    for (int k = 0; k < GSCL_PARAMS; k++) params[k] = 0.0f;
    params[GSCL_X] = ((float)at.x + gscl_random_unit_of(random_state(seed, i, 1))) * t.scale;
    params[GSCL_Y] = ((float)at.y + gscl_random_unit_of(random_state(seed, i, 2))) * t.scale;
    params[GSCL_LOG_S1] = params[GSCL_LOG_S2] = log(sigma);
    params[GSCL_OPACITY] = t.opacity;
    for (int k = 0; k < t.channels; k++)
        params[GSCL_COLOUR + k] = planes[((size_t)k * t.height + at.y) * t.width + at.x];
    if (t.is_rotated != 0) follow_edge(t, tensor, params);
}
