/* The rendering of a rate-distortion pass, and adding a splat to it or removing it. */

/* What a pass reads and changes. */
typedef struct {
    __global float *rendering, *weights; /* planes; the sums of weights of `normalized` */
    __global const float *target;        /* CHANNELS planes and those of WEIGHTED */
    int width, height;
    ulong plane; /* floats of a plane */
} rdo_planes;

/* The wave of a splat at a row of pixels, `dx` and `dy` from its centre. */
pix projected_wave(pix dx, float dy, const projected_splat *a) {
    const float *d = a->projected;
    return d[GSCL_PROJECTED_WAVE_AMPLITUDE] *
           pix_wave(dx, dy, d[GSCL_PROJECTED_WAVE_X], d[GSCL_PROJECTED_WAVE_Y], d[GSCL_PROJECTED_WAVE_PHASE]);
}

bool has_wave(const projected_splat *a) { return TEXTURE && a->projected[GSCL_PROJECTED_WAVE_AMPLITUDE] > 0.0f; }

/* Adds the splat to the rendering (sign 1) or removes it (sign -1), after sums for which all have read the planes. */
ITEMS_INLINE void rendering_change(const projected_splat *a, float sign, const rdo_planes *p) {
    outline o = outline_of(a, p->width, p->height);
    FOR_ROWS(RDO_ITEMS, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y) {
            size_t at = (size_t)y * p->width + x;
            int lanes = columns.y - x + 1;
            pix dx = pix_offsets() + ((float)x + 0.5f - o.x), wave = (pix)(0.0f);
            float dy = (float)y + 0.5f - o.y;
            pix w = sign * blend_weight(dx, dy, a), values[CHANNELS];
            UNROLL
            for (int k = 0; k < CHANNELS; k++) values[k] = RDO_LOAD(p->rendering + k * p->plane + at, lanes);
            if (has_wave(a)) wave = projected_wave(dx, dy, a);
            if (BLEND == GSCL_NORMALIZED) {
                pix sum = RDO_LOAD_WEIGHTS(p->weights + at, lanes) + w;
                pix_store_clipped(sum, p->weights + at, lanes);
                w /= sum;
            }
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix c = (pix)(a->projected[GSCL_PROJECTED_COLOUR + k]);
                if (k < COLOURS) c += wave;
                pix_store_clipped(BLEND == GSCL_NORMALIZED ? fma(w, c - values[k], values[k]) : fma(w, c, values[k]),
                                  p->rendering + k * p->plane + at, lanes);
            }
        }
    }
    RDO_SYNCHRONISE();
}
