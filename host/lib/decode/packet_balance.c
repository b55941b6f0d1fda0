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

/* The emptiest of the packets that may hold the splat; s->target.count: none has room. */
static uint32_t emptiest_for(const gscl_packet_split *s, uint32_t splat) {
    const uint32_t none = s->target.count;
    const gsf_packet_choice choice = gsf_packet_choice_of(s->file, splat, none);
    uint32_t best = none;
    for (uint32_t i = 0; i < none; i++)
        if (has_room(s, i) && (best == none || s->sizes[i] < s->sizes[best]) && gsf_packet_is_allowed(&choice, i))
            best = i;
    return best;
}

/* A splat before it is moved. */
typedef struct splat_frame {
    double x, y;          /* centre, pixels */
    double s1, s2, c, sn; /* axes, pixels, and the direction of the first one */
    double slope;
} splat_frame;

static splat_frame frame_of(const gsf_coded_image *file, const gsf_splat *splat) {
    float params[GSCL_PARAMS];
    gscl_dequantise(file, splat, params);
    return (splat_frame){.x = params[GSCL_X],
                         .y = params[GSCL_Y],
                         .s1 = gscl_exp(params[GSCL_LOG_S1]),
                         .s2 = gscl_exp(params[GSCL_LOG_S2]),
                         .c = gscl_cos(params[GSCL_THETA]),
                         .sn = gscl_sin(params[GSCL_THETA]),
                         .slope = gscl_tan(params[GSCL_THETA])};
}

/* The squared difference of a Gaussian and the same at another place, over all pixels: 1 - exp(-d^2 / 4) times their areas,
 * with d the distance in units of the axes. */
static double moving_cost(const splat_frame *from, const float *to) {
    const double dx = to[GSCL_X] - from->x, dy = to[GSCL_Y] - from->y;
    const double u = (dx * from->c + dy * from->sn) / from->s1, v = (dy * from->c - dx * from->sn) / from->s2;
    return from->s1 * from->s2 * (1 - gscl_exp(-(u * u + v * v) / 4));
}

/* The part of a cell, `cells` cells away, on the line along the major axis, or the nearest to it: place `at` is moved. */
static int64_t part_near(uint32_t at, uint32_t parts, int cells, double line) {
    const int64_t first = (at / parts + (int64_t)cells) * parts, wanted = at + (int64_t)floor(line * parts + 0.5);
    return wanted < first ? first : wanted >= first + parts ? first + (int64_t)parts - 1 : wanted;
}

/* Moves a splat by some cells of its class, as much along its major axis as these allow.  False beyond the image. */
static bool shift_splat(const gsf_splat_grid *grid, gsf_splat *splat, double slope, int dx, int dy) {
    const bool is_steep = grid->parts_x > 1;
    const int64_t x = part_near(splat->x, grid->parts_x, dx, is_steep ? dy / slope : dx);
    const int64_t y = part_near(splat->y, grid->parts_y, dy, is_steep ? dy : dx * slope);
    splat->x = (uint32_t)x;
    splat->y = (uint32_t)y;
    return x >= 0 && y >= 0 && x < grid->cells_x && y < grid->cells_y;
}

/* Looks for the packet of the splat, which is moved now, and keeps the move where it is the best so far. */
static void consider_place(const gscl_packet_split *s, uint32_t splat, const splat_frame *from, packet_move *best) {
    const gsf_splat *moved = &s->file->splats[splat];
    float to[GSCL_PARAMS];
    gscl_dequantise(s->file, moved, to);
    const double cost = moving_cost(from, to);
    const uint32_t packet = cost < best->cost ? emptiest_for(s, splat) : s->target.count;
    if (packet < s->target.count)
        *best = (packet_move){splat, packet, moved->x, moved->y, cost};
}

/* Tries all places of a splat. */
static void consider_splat(const gscl_packet_split *s, uint32_t splat, packet_move *best) {
    gsf_splat *at = &s->file->splats[splat];
    const gsf_splat before = *at;
    const splat_frame from = frame_of(s->file, at);
    const gsf_splat_grid grid = gsf_splat_grid_of(&s->file->header, &s->file->steps, at);
    for (int dy = -MAX_SHIFT; dy <= MAX_SHIFT; dy++)
        for (int dx = -MAX_SHIFT; dx <= MAX_SHIFT; dx++) {
            if (shift_splat(&grid, at, from.slope, dx, dy))
                consider_place(s, splat, &from, best);
            *at = before;
        }
}

static packet_move find_move(const gscl_packet_split *s, uint32_t from) {
    packet_move best = {.cost = INFINITY};
    for (uint32_t i = 0; i < s->file->header.splat_count; i++)
        if (s->packet_of[i] == from)
            consider_splat(s, i, &best);
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
