#include "scalar/search_pool.h"

#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/dequantise.h"
#include "scalar/scalar_fit.h"

#define CELLS GSCL_SEARCH_CELLS

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

void gscl_search_pool_free(gscl_search_pool *pool) {
    for (size_t i = 0; i < pool->count; i++)
        gscl_kept_codes_free(&pool->members[i].codes);
    gscl_kept_codes_free(&pool->within);
    free(pool->members);
    free(pool->error);
    *pool = (gscl_search_pool){0};
}

/* The cell of a point, `position` of `size` along one side. */
static int cell_at(double position, double size) {
    const int cell = (int)(CELLS * position / size);
    return cell < 0 ? 0 : cell < CELLS ? cell : CELLS - 1;
}

static gscl_result reserve_error(gscl_search_pool *pool, const gscl_scalar_state *s, size_t pixels) {
    if (pool->pixels != pixels) {
        free(pool->error);
        pool->error = malloc(pixels * sizeof *pool->error);
        pool->pixels = pool->error ? pixels : 0;
    }
    return pool->error ? GSCL_OK : gscl_fail_memory(s->encoder->context);
}

/* Adds the error of each pixel of s->coded to its cell. */
static gscl_result measure_cells(gscl_search_pool *pool, gscl_scalar_state *s, gscl_search_cells cells) {
    const uint32_t width = gscl_fit_level_width(&s->fit), height = gscl_fit_level_height(&s->fit);
    GSCL_TRY(reserve_error(pool, s, (size_t)width * height));
    GSCL_TRY(gscl_scalar_measure_pixels(s, pool->error));
    memset(cells, 0, sizeof(gscl_search_cells));
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            cells[cell_at(y + 0.5, height)][cell_at(x + 0.5, width)] += (double)pool->error[(size_t)y * width + x];
    return GSCL_OK;
}

gscl_result gscl_search_pool_add(gscl_search_pool *pool, gscl_scalar_state *s, double error) {
    if (pool->count == pool->capacity) {
        gscl_search_member *grown = realloc(pool->members, (2 * pool->capacity + 1) * sizeof *grown);
        if (!grown)
            return gscl_fail_memory(s->encoder->context);
        pool->members = grown;
        pool->capacity = 2 * pool->capacity + 1;
    }
    gscl_search_member *member = &pool->members[pool->count++];
    memset(member, 0, sizeof *member);
    for (int y = 0; y < CELLS; y++)
        for (int x = 0; x < CELLS; x++)
            member->weight[y][x] = 1;
    GSCL_TRY(gscl_kept_codes_keep(&member->codes, s, error));
    return measure_cells(pool, s, member->error);
}

gscl_search_part gscl_search_best_part(gscl_search_cells gain) {
    gscl_search_part best = {0};
    for (int y0 = 0; y0 < CELLS; y0++) {
        double column[CELLS] = {0}; /* sums of rows y0..y */
        for (int y = y0; y < CELLS; y++) {
            double sum = 0; /* of the columns x0..x, of which no beginning has a negative sum */
            for (int x = 0, x0 = 0; x < CELLS; x++) {
                column[x] += gain[y][x];
                if (sum <= 0) {
                    sum = 0;
                    x0 = x;
                }
                sum += column[x];
                if (sum > best.gain)
                    best = (gscl_search_part){x0, x + 1, y0, y + 1, sum};
            }
        }
    }
    return best;
}

static gscl_search_part part_of_member(const gscl_search_member *member, gscl_search_cells error) {
    gscl_search_cells gain;
    for (int y = 0; y < CELLS; y++)
        for (int x = 0; x < CELLS; x++) {
            gain[y][x] = error[y][x] - member->error[y][x];
            if (gain[y][x] > 0)
                gain[y][x] *= member->weight[y][x];
        }
    return gscl_search_best_part(gain);
}

/* Whether the centre of a splat of the coded image lies in the part. */
static bool is_inside(const gscl_coded_image *coded, uint32_t splat, const gscl_search_part *part) {
    float params[GSCL_PARAMS];
    gscl_dequantise_splat(&coded->file, splat, params);
    const int x = cell_at((double)params[GSCL_X], coded->file.header.width);
    const int y = cell_at((double)params[GSCL_Y], coded->file.header.height);
    return x >= part->x0 && x < part->x1 && y >= part->y0 && y < part->y1;
}

/* Of the splats from number `from` on, keeps those inside (or outside) of the part. */
static void keep_splats(gscl_coded_image *coded, uint32_t from, const gscl_search_part *part, bool inside) {
    gsf_coded_image *file = &coded->file;
    uint32_t kept = from;
    for (uint32_t i = from; i < file->header.splat_count; i++)
        if (is_inside(coded, i, part) == inside)
            file->splats[kept++] = file->splats[i];
    file->header.splat_count = kept;
}

static gscl_result take_part(gscl_scalar_state *s, gscl_search_member *member, const gscl_search_part *part) {
    gsf_coded_image *file = &s->coded->file;
    keep_splats(s->coded, 0, part, false);
    const uint32_t kept = file->header.splat_count;
    GSCL_TRY(gscl_coded_image_reserve(s->coded, kept + member->codes.count));
    memcpy(file->splats + kept, member->codes.splats, member->codes.count * sizeof *file->splats);
    file->header.splat_count = kept + member->codes.count;
    keep_splats(s->coded, kept, part, true);
    for (int y = part->y0; y < part->y1; y++)
        for (int x = part->x0; x < part->x1; x++)
            member->weight[y][x] *= tunables->search_taken_weight;
    return GSCL_OK;
}

gscl_result gscl_search_pool_combine(gscl_search_pool *pool, gscl_scalar_state *s, bool *is_combined) {
    gscl_search_cells error;
    gscl_search_member *from = NULL;
    gscl_search_part best = {0};
    GSCL_TRY(measure_cells(pool, s, error));
    for (size_t i = 0; i < pool->count; i++) {
        const gscl_search_part part = part_of_member(&pool->members[i], error);
        if (part.gain > best.gain) {
            best = part;
            from = &pool->members[i];
        }
    }
    *is_combined = from != NULL;
    return from ? take_part(s, from, &best) : GSCL_OK;
}
