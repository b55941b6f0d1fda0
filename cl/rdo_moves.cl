/* Moves of a splat to neighbouring codes, and the bits of its codes. */

/* Move 0 changes nothing but the colour. */
#define MOVES (GSCL_RDO_MOVES + (OPACITY ? GSCL_RDO_OPACITY_MOVES : 0))
/* Each of these moves is one step up; the move after it is one step down. */
#define MOVE_ANGLE 7
#define MOVE_X 9
#define MOVE_Y 11
#define MOVE_OPACITY 13

/* What a move changes of the codes of the axes. */
__constant int major_step[GSCL_RDO_MOVES + GSCL_RDO_OPACITY_MOVES] = {0, 1, -1, 1, -1, 0, 0};
__constant int aspect_step[GSCL_RDO_MOVES + GSCL_RDO_OPACITY_MOVES] = {0, 0, 0, 1, -1, -1, 1};

/* One step along x or y.  Across the cells of the class it goes along the major axis, whose direction is `d`, else to the
 * next part of a cell.  False when it leaves the image. */
ITEMS_INLINE bool centre_move(gscl_codes *c, bool along_x, int step, const splat_grid *g, unit_vector d) {
    int parts = along_x ? g->parts.y : g->parts.x, other_step = 0;
    if (parts > 1) {
        float slope = along_x ? d.y / d.x : d.x / d.y;
        other_step = (int)rint((float)(step * parts) * slope);
    }
    int x = c->code[GSCL_CODE_X] += along_x ? step : other_step;
    int y = c->code[GSCL_CODE_Y] += along_x ? other_step : step;
    return x >= 0 && x < g->cells.x && y >= 0 && y < g->cells.y;
}

/* Quantises the colour again where the fineness was another. */
ITEMS_INLINE void codes_set_fineness(gscl_codes *c, int before, int fineness, gscl_rdo_settings t) {
    if (before == fineness) return;
    ITEMS_UNROLL
    for (int i = 0; i < COLOURS; i++) {
        int code = (int)rint((float)(c->code[GSCL_CODE_LUMA + i] * fineness) / (float)before);
        c->code[GSCL_CODE_LUMA + i] = clamp(code, t.min[i] * fineness, (t.max[i] + 1) * fineness - 1);
    }
}

/* Makes a move; false when it leaves the code's range.  When an axis changes, position, angle and colour are quantised
 * again with their new steps. */
ITEMS_INLINE bool codes_move(gscl_codes *c, int move, __global const gscl_rdo_tables *tables, gscl_rdo_settings t) {
    __global const gscl_major_entry *majors = tables->majors;
    __global const gscl_aspect_entry *aspects = tables->aspects;
    if (!ANISOTROPY && aspect_step[move] != 0) return false;
    if (!ROTATION && (move == MOVE_ANGLE || move == MOVE_ANGLE + 1)) return false;
    if (move >= MOVE_OPACITY) {
        c->code[GSCL_CODE_OPACITY] += move == MOVE_OPACITY ? 1 : -1;
        return OPACITY && c->code[GSCL_CODE_OPACITY] >= 0 && (float)c->code[GSCL_CODE_OPACITY] < t.opacity_levels;
    }
    splat_grid g = codes_grid(c, majors, aspects);
    if (move == MOVE_X || move == MOVE_X + 1 || move == MOVE_Y || move == MOVE_Y + 1) {
        bool along_x = move == MOVE_X || move == MOVE_X + 1;
        return centre_move(c, along_x, move == (along_x ? MOVE_X : MOVE_Y) ? 1 : -1, &g,
                           axis_direction(codes_theta(c, aspects)));
    }
    if (move == 0) return true;
    float2 centre = codes_centre(c, &g);
    int angles = aspects[c->code[GSCL_CODE_ASPECT]].angles;
    float turn = (float)c->code[GSCL_CODE_ANGLE] / (float)angles;
    int fineness = codes_fineness(c, tables);
    c->code[GSCL_CODE_MAJOR] += major_step[move];
    c->code[GSCL_CODE_ASPECT] += aspect_step[move];
    if (c->code[GSCL_CODE_MAJOR] < 0 || c->code[GSCL_CODE_ASPECT] < 0 || c->code[GSCL_CODE_MAJOR] > GSCL_MAX_SCALE ||
        c->code[GSCL_CODE_ASPECT] > c->code[GSCL_CODE_MAJOR])
        return false;
    codes_set_fineness(c, fineness, codes_fineness(c, tables), t);
    angles = aspects[c->code[GSCL_CODE_ASPECT]].angles;
    if (aspect_step[move] != 0) c->code[GSCL_CODE_ANGLE] = (int)rint(turn * (float)angles) % angles;
    if (move == MOVE_ANGLE || move == MOVE_ANGLE + 1) {
        if (angles < 2) return false;
        c->code[GSCL_CODE_ANGLE] = (c->code[GSCL_CODE_ANGLE] + (move == MOVE_ANGLE ? 1 : angles - 1)) % angles;
    }
    g = codes_grid(c, majors, aspects);
    codes_set_centre(c, centre, &g, axis_direction(codes_theta(c, aspects)));
    return true;
}

/* What the direction adds to the bits of an angle. */
float codes_direction_bits(const gscl_codes *c, __global const gscl_rdo_tables *tables) {
    int aspect = c->code[GSCL_CODE_ASPECT], angles = tables->aspects[aspect].angles;
    if (!ROTATION || angles < 2) return 0.0f;
    int bin = (2 * GSCL_DIRECTIONS * c->code[GSCL_CODE_ANGLE] + angles) / (2 * angles) % GSCL_DIRECTIONS;
    return tables->direction_bits[min(aspect / 2, GSCL_DIRECTION_ROWS - 1)][bin];
}

/* The bits of a splat's wave, or of having none. */
float wave_bits(const gscl_codes *c, __global const float *restrict tables) {
    if (!TEXTURE) return 0.0f;
    if (c->code[GSCL_CODE_AMPLITUDE] == 0) return tables[GSCL_BITS_PLAIN];
    return tables[GSCL_BITS_TEXTURED] + tables[GSCL_BITS_WAVE + c->code[GSCL_CODE_WAVE]] +
           tables[GSCL_BITS_DIRECTION + c->code[GSCL_CODE_DIRECTION]] +
           tables[GSCL_BITS_AMPLITUDE + c->code[GSCL_CODE_AMPLITUDE] - 1];
}

/* The bits of all codes but those of the colour. */
float codes_bits(const gscl_codes *c, __global const gscl_rdo_tables *tables) {
    int major = c->code[GSCL_CODE_MAJOR], aspect = c->code[GSCL_CODE_ASPECT];
    float bits = wave_bits(c, tables->bits) + codes_direction_bits(c, tables);
    if (OPACITY) bits += tables->bits[GSCL_BITS_OPACITY + c->code[GSCL_CODE_OPACITY]];
    return bits + tables->majors[major].bits + tables->aspects[aspect].bits + tables->shape_bits[major][aspect];
}

/* The part of the price of an elongated splat that is due at this difference of ln sigma. */
float elongation(float log_aspect) { return clamp((0.5f / M_LN2_F) * log_aspect - 1.0f, 0.0f, 1.0f); }
