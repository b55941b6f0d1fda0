#include "decode/packet_balance.h"

#include <math.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/dequantise.h"
#include "format/classes.h"
#include "format/quantiser.h"
#include "runtime/elementary.h"

#define MAX_SHIFT 3       /* cells by which a splat moves at most; more brings nothing */
#define MIN_ROOM_BYTES 4u /* of a packet that takes a splat: about its size */
#define FEW_MOVES 64u     /* moves besides one for each splat, after which splats are dropped */

/* A splat's place in another packet. */
typedef struct packet_move {
    uint32_t splat, packet;
    uint32_t x, y;
    double cost; /* INFINITY: none */
} packet_move;

static bool has_room(const gscl_packet_split *s, uint32_t packet) {
    return s->sizes[packet] + MIN_ROOM_BYTES <= s->target.limit;
}

/* The emptiest of the packets that may hold the splat; s->packets: none has room. */
static uint32_t emptiest_for(const gscl_packet_split *s, uint32_t splat) {
    uint32_t best = s->packets;
    for (uint32_t i = 0; i < s->packets; i++)
        if (has_room(s, i) && (best == s->packets || s->sizes[i] < s->sizes[best]) &&
            gsf_packet_may_hold(s->file, splat, s->packets, i))
            best = i;
    return best;
}

/* The squared difference of a Gaussian and the same at another place, over all pixels: 1 - exp(-d^2 / 4) times their areas,
 * with d the distance in units of the axes. */
static double moving_cost(const float *from, const float *to) {
    const double dx = (double)to[GSCL_X] - from[GSCL_X], dy = (double)to[GSCL_Y] - from[GSCL_Y];
    const double c = gscl_cos(from[GSCL_THETA]), sn = gscl_sin(from[GSCL_THETA]);
    const double s1 = gscl_exp(from[GSCL_LOG_S1]), s2 = gscl_exp(from[GSCL_LOG_S2]);
    const double u = (dx * c + dy * sn) / s1, v = (dy * c - dx * sn) / s2;
    return s1 * s2 * (1 - gscl_exp(-(u * u + v * v) / 4));
}

/* The part of a cell, `cells` cells away, on the line along the major axis, or the nearest to it: place `at` is moved. */
static int64_t part_near(uint32_t at, uint32_t parts, int cells, double line) {
    const int64_t first = (at / parts + (int64_t)cells) * parts, wanted = at + (int64_t)floor(line * parts + 0.5);
    return wanted < first ? first : wanted >= first + parts ? first + (int64_t)parts - 1 : wanted;
}

/* Moves a splat by some cells of its class, as much along its major axis as these allow.  False beyond the image. */
static bool shift_splat(const gsf_coded_image *file, gsf_splat *splat, double theta, int dx, int dy) {
    const gsf_splat_grid grid = gsf_splat_grid_of(&file->header, &file->steps, splat);
    const bool is_steep = grid.parts_x > 1;
    const double slope = gscl_tan(theta);
    const int64_t x = part_near(splat->x, grid.parts_x, dx, is_steep ? dy / slope : dx);
    const int64_t y = part_near(splat->y, grid.parts_y, dy, is_steep ? dy : dx * slope);
    splat->x = (uint32_t)x;
    splat->y = (uint32_t)y;
    return x >= 0 && y >= 0 && x < grid.cells_x && y < grid.cells_y;
}

/* Looks for the packet of the splat at a place that is some cells away, and keeps the move where it is the best so far. */
static void consider_place(const gscl_packet_split *s, uint32_t splat, int dx, int dy, packet_move *best) {
    gsf_splat *at = &s->file->splats[splat];
    const gsf_splat before = *at;
    float from[GSCL_PARAMS], to[GSCL_PARAMS];
    gscl_dequantise(s->file, at, from);
    if (shift_splat(s->file, at, from[GSCL_THETA], dx, dy)) {
        gscl_dequantise(s->file, at, to);
        const double cost = moving_cost(from, to);
        const uint32_t packet = cost < best->cost ? emptiest_for(s, splat) : s->packets;
        if (packet < s->packets)
            *best = (packet_move){splat, packet, at->x, at->y, cost};
    }
    *at = before;
}

static packet_move find_move(const gscl_packet_split *s, uint32_t from) {
    packet_move best = {.cost = INFINITY};
    for (uint32_t i = 0; i < s->file->header.splat_count; i++)
        for (int dy = -MAX_SHIFT; s->packet_of[i] == from && dy <= MAX_SHIFT; dy++)
            for (int dx = -MAX_SHIFT; dx <= MAX_SHIFT; dx++)
                consider_place(s, i, dx, dy, &best);
    return best;
}

static void drop_splat(gscl_packet_split *s, uint32_t splat) {
    gsf_coded_image *file = s->file;
    const uint32_t behind = file->header.splat_count - splat - 1;
    memmove(&file->splats[splat], &file->splats[splat + 1], behind * sizeof file->splats[0]);
    memmove(&s->packet_of[splat], &s->packet_of[splat + 1], behind * sizeof s->packet_of[0]);
    file->header.splat_count--;
}

/* Whether another splat has the same codes: a reader takes one of them only. */
static bool has_equal(const gsf_coded_image *file, uint32_t splat) {
    bool found = false;
    for (uint32_t i = 0; i < file->header.splat_count && !found; i++)
        found = i != splat && memcmp(&file->splats[i], &file->splats[splat], sizeof file->splats[i]) == 0;
    return found;
}

static gscl_result make_move(gscl_packet_split *s, const packet_move *move) {
    const uint32_t from = s->packet_of[move->splat];
    s->file->splats[move->splat].x = move->x;
    s->file->splats[move->splat].y = move->y;
    s->packet_of[move->splat] = (uint16_t)move->packet;
    if (has_equal(s->file, move->splat))
        drop_splat(s, move->splat);
    const gscl_result result = gscl_packet_split_measure(s, from);
    return result == GSCL_OK ? gscl_packet_split_measure(s, move->packet) : result;
}

/* Fails where the packet has no splats: its header is too large. */
static gscl_result drop_smallest(gscl_packet_split *s, uint32_t packet) {
    gsf_coded_image *file = s->file;
    uint32_t smallest = file->header.splat_count;
    for (uint32_t i = 0; i < file->header.splat_count; i++)
        if (s->packet_of[i] == packet && (smallest == file->header.splat_count ||
                                          2 * file->splats[i].major - file->splats[i].aspect <
                                              2 * file->splats[smallest].major - file->splats[smallest].aspect))
            smallest = i;
    if (smallest == file->header.splat_count)
        return GSCL_ERROR_BUDGET_TOO_SMALL;
    drop_splat(s, smallest);
    return gscl_packet_split_measure(s, packet);
}

gscl_result gscl_packet_balance(gscl_packet_split *s) {
    uint32_t moves = s->file->header.splat_count + FEW_MOVES;
    for (;;) {
        const uint32_t packet = gscl_packet_split_fullest(s);
        if (s->sizes[packet] <= s->target.limit)
            return GSCL_OK;
        const packet_move move = moves > 0 ? find_move(s, packet) : (packet_move){.cost = INFINITY};
        moves -= moves > 0;
        const gscl_result result = move.cost < INFINITY ? make_move(s, &move) : drop_smallest(s, packet);
        if (result != GSCL_OK)
            return result;
    }
}
