/* The rate-distortion passes: dequantising a splat's codes. */

/* Cycles per pixel (FORMAT.md, "Dequantisation"). */
float wave_frequency(int wave) { return (1.0f / GSCL_FIRST_WAVELENGTH) * exp2(-GSCL_OCTAVES_PER_WAVE * (float)wave); }

float wave_amplitude(int code, gscl_rdo_settings t) {
    return fmin((float)code * t.amplitude_step, GSCL_LARGEST_AMPLITUDE);
}

/* The parts of a level of luma and chroma. */
int codes_fineness(const gscl_codes *c, __global const gscl_rdo_tables *tables) {
    return tables->fineness[2 * c->code[GSCL_CODE_MAJOR] - c->code[GSCL_CODE_ASPECT]];
}

void codes_colour(const gscl_codes *c, float fineness, gscl_rdo_settings t, float *restrict colour) {
    float y = (float)c->code[GSCL_CODE_LUMA] * (t.luma_step / fineness);
#if COLOURS == 3
    float chroma = t.chroma_step / fineness;
    float co = (float)c->code[GSCL_CODE_CO] * chroma, cg = (float)c->code[GSCL_CODE_CG] * chroma;
    colour_from_ycocg(y, co, cg, colour);
#else
    colour[0] = y;
#endif
#if ALPHA_CHANNEL
    colour[COLOURS] = (float)c->code[GSCL_CODE_ALPHA] * t.alpha_step;
#endif
}

/* The cells in which the centre of one splat lies (gsf_splat_grid in format/quantiser.h). */
typedef struct {
    int2 parts, cells;
    float2 step; /* pixels */
} splat_grid;

/* The angle of the major axis. */
float codes_theta(const gscl_codes *c, __global const gscl_aspect_entry *aspects) {
    return ROTATION ? (float)c->code[GSCL_CODE_ANGLE] * M_PI_F / (float)aspects[c->code[GSCL_CODE_ASPECT]].angles
                    : 0.0f;
}

splat_grid codes_grid(const gscl_codes *c, __global const gscl_major_entry *majors,
                      __global const gscl_aspect_entry *aspects) {
    __global const gscl_major_entry *m = majors + c->code[GSCL_CODE_MAJOR];
    __global const gscl_aspect_entry *a = aspects + c->code[GSCL_CODE_ASPECT];
    int angle4 = 4 * c->code[GSCL_CODE_ANGLE];
    bool steep = ROTATION && angle4 > a->angles && angle4 < 3 * a->angles;
    splat_grid g;
    g.parts = steep ? (int2)(a->parts, 1) : (int2)(1, a->parts);
    g.cells = (int2)(m->cells_x * g.parts.x, m->cells_y * g.parts.y);
    g.step = (float2)(m->step / (float)g.parts.x, m->step / (float)g.parts.y);
    return g;
}

/* Without the rounding to 1/512 pixel of the format, whose effect is small beside that of the cells. */
float2 codes_centre(const gscl_codes *c, const splat_grid *g) {
    return (float2)(((float)c->code[GSCL_CODE_X] + 0.5f) * g->step.x, ((float)c->code[GSCL_CODE_Y] + 0.5f) * g->step.y);
}

/* Quantises a centre.  Rounding to a cell of the class moves it along the major axis, whose direction is `d`. */
void codes_set_centre(gscl_codes *c, float2 at, const splat_grid *g, unit_vector d) {
    if (g->parts.x > 1) {
        int y = clamp((int)(at.y / g->step.y), 0, g->cells.y - 1);
        at.x += (((float)y + 0.5f) * g->step.y - at.y) * d.x / d.y;
    } else if (g->parts.y > 1) {
        int x = clamp((int)(at.x / g->step.x), 0, g->cells.x - 1);
        at.y += (((float)x + 0.5f) * g->step.x - at.x) * d.y / d.x;
    }
    c->code[GSCL_CODE_X] = clamp((int)(at.x / g->step.x), 0, g->cells.x - 1);
    c->code[GSCL_CODE_Y] = clamp((int)(at.y / g->step.y), 0, g->cells.y - 1);
}

/* Place and shape of a splat: pixels, ln sigma, radians. */
typedef struct {
    float x, y, major, minor, theta;
} splat_geometry;

splat_geometry codes_geometry(const gscl_codes *c, __global const gscl_major_entry *majors,
                              __global const gscl_aspect_entry *aspects, gscl_rdo_settings t) {
    splat_geometry s;
    splat_grid g = codes_grid(c, majors, aspects);
    float2 centre = codes_centre(c, &g);
    s.x = centre.x;
    s.y = centre.y;
    s.major = fmin((float)c->code[GSCL_CODE_MAJOR] * t.scale_step - M_LN2_F, GSCL_LOG_LARGEST_AXIS);
    s.minor = fmin((float)(c->code[GSCL_CODE_MAJOR] - c->code[GSCL_CODE_ASPECT]) * t.scale_step - M_LN2_F,
                   GSCL_LOG_LARGEST_AXIS);
    s.minor = fmax(s.minor, s.major - GSCL_LOG_LARGEST_ASPECT);
    s.theta = codes_theta(c, aspects);
    return s;
}

splat codes_splat(const gscl_codes *c, __global const gscl_rdo_tables *tables, gscl_rdo_settings t) {
    splat s;
    splat_geometry g = codes_geometry(c, tables->majors, tables->aspects, t);
    s.x = g.x;
    s.y = g.y;
    splat_set_axes(&s, g.major, g.minor);
    s.theta = g.theta;
    s.opacity = OPACITY ? ((float)c->code[GSCL_CODE_OPACITY] + 1.0f) / t.opacity_levels : 1.0f;
    codes_colour(c, (float)codes_fineness(c, tables), t, s.colour);
    if (!TEXTURE) return s;
    s.wave_x = s.wave_y = 0.0f;
    if (c->code[GSCL_CODE_AMPLITUDE] > 0) {
        float frequency = wave_frequency(c->code[GSCL_CODE_WAVE]);
        unit_vector d = direction_of((float)c->code[GSCL_CODE_DIRECTION] * (M_PI_F / GSCL_DIRECTIONS));
        s.wave_x = frequency * d.x;
        s.wave_y = frequency * d.y;
    }
    s.wave_phase = (float)c->code[GSCL_CODE_PHASE] * (1.0f / GSCL_PHASES);
    s.wave_amplitude = wave_amplitude(c->code[GSCL_CODE_AMPLITUDE], t);
    if (g.major > GSCL_LOG_LARGEST_WAVED_AXIS) s.wave_amplitude = 0.0f;
    return s;
}

/* What teams offer each other, behind their sums in local memory: codes with their cost. */
#define OFFER (1 + GSCL_CODE_COUNT)
#define OFFERS(shared) ((shared) + SUMS_SHARED)
/* Floats of local memory of a group that visits a splat. */
#define VISIT_SHARED (RDO_ITEMS > 1 ? SUMS_SHARED + MAX_TEAMS * OFFER : 1)

#if RDO_ITEMS > 1
ITEMS_INLINE void codes_offer(const gscl_codes *c, float cost, __local float *offer) {
    offer[0] = cost;
    UNROLL
    for (int k = 0; k < GSCL_CODE_COUNT; k++) offer[1 + k] = as_float(c->code[k]);
}

/* Takes those of the least cost, the first of several, where it is below `cost`; returns the least cost. */
ITEMS_INLINE float codes_take(gscl_codes *c, float cost, int count, __local const float *offers) {
    int least = -1;
    for (int i = 0; i < count; i++) {
        if (!(offers[i * OFFER] < cost)) continue;
        cost = offers[i * OFFER];
        least = i;
    }
    if (least < 0) return cost;
    UNROLL
    for (int k = 0; k < GSCL_CODE_COUNT; k++) c->code[k] = as_int(offers[least * OFFER + 1 + k]);
    return cost;
}
#endif
