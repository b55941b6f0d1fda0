/* The pixel vector: a work-item handles LANES neighbouring pixels of a row at once, in ROWS rows.  CPU mapping: LANES
 * 16, ROWS 16; a work-item draws a whole tile with explicit vectors.  GPU mapping: LANES 4, ROWS 1; a work-group of
 * 256 / LANES work-items draws a tile; kernels of visual.cl and ssim.cl have LANES 1.  Some implementations get other values of
 * both (host/lib/opencl/quirks.c).
 *
 * Build options, each where the kernels depend on it (host/lib/opencl/build_options.c): LANES, ROWS, COLOURS (1 or 3),
 * ALPHA_CHANNEL, OPACITY, TEXTURE, SHAPE, BLEND, WEIGHTED (GSCL_WEIGHTED_...), LOSS, CACHED_ROWS (raster.cl), and
 * CHUNK_ITEMS, the work-items of a group that take a pixel vector each.  The options DOUBLE, EXPONENTIAL, EARLY_STOP and
 * GSCL_SUPPORT serve measurements of accuracy only (host/lib/measure/accuracy.c). */
#ifdef DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double real;
#define REALS(n) double##n
#define MASKS(n) long##n
#define EXPONENTIAL GSCL_EXPONENTIAL_EXACT
#else
typedef float real;
#define REALS(n) float##n
#define MASKS(n) int##n
#endif
#ifndef EXPONENTIAL
#define EXPONENTIAL GSCL_EXPONENTIAL_POLYNOMIAL
#endif

#define CHANNELS (COLOURS + ALPHA_CHANNEL)
#define ITEMS_X (GSCL_TILE / LANES)
#define ITEMS_Y (GSCL_TILE / ROWS)
#define ITEMS GSCL_TILE_ITEMS(LANES, ROWS)
#define ROTATION (SHAPE == GSCL_SHAPE_ROTATED)
#define ANISOTROPY (SHAPE != GSCL_SHAPE_ISOTROPIC)

#if LANES == 16
typedef REALS(16) pix;
typedef MASKS(16) pix_mask;
#define PIX_LOAD(p) vload16(0, p)
#define PIX_STORE(v, p) vstore16(v, 0, p)
#define PIX_INT(v) convert_int16(v)
#define PIX_FLOAT(v) convert_float16(v)
#define PIX_FIRST(v) ((v).s0)
#define PIX_BITS(v) as_int16(v)
#define PIX_OF_BITS(v) as_float16(v)
#define PIX_MASK(comparison) (comparison)
pix pix_offsets(void) { return (pix)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15); }
real pix_sum(pix v) {
    REALS(8) a = v.lo + v.hi;
    REALS(4) b = a.lo + a.hi;
    REALS(2) c = b.lo + b.hi;
    return c.x + c.y;
}
#elif LANES == 4
typedef REALS(4) pix;
typedef MASKS(4) pix_mask;
#define PIX_LOAD(p) vload4(0, p)
#define PIX_STORE(v, p) vstore4(v, 0, p)
#define PIX_INT(v) convert_int4(v)
#define PIX_FLOAT(v) convert_float4(v)
#define PIX_FIRST(v) ((v).s0)
#define PIX_BITS(v) as_int4(v)
#define PIX_OF_BITS(v) as_float4(v)
#define PIX_MASK(comparison) (comparison)
pix pix_offsets(void) { return (pix)(0, 1, 2, 3); }
real pix_sum(pix v) {
    REALS(2) c = v.lo + v.hi;
    return c.x + c.y;
}
#elif LANES == 1
typedef real pix;
typedef MASKS() pix_mask;
#define PIX_LOAD(p) (*(p))
#define PIX_STORE(v, p) (*(p) = (v))
#define PIX_INT(v) convert_int(v)
#define PIX_FLOAT(v) convert_float(v)
#define PIX_FIRST(v) (v)
#define PIX_BITS(v) as_int(v)
#define PIX_OF_BITS(v) as_float(v)
#define PIX_MASK(comparison) ((pix_mask)(-(comparison)))
pix pix_offsets(void) { return 0.0f; }
real pix_sum(pix v) { return v; }
#else
#error "LANES must be 16, 4 or 1"
#endif

/* The part of luma that a colour channel has. */
__constant float luma_shares[3] = {GSCL_LUMA_SHARES};
float luma_share(int k) { return COLOURS == 3 ? luma_shares[k] : 1.0f; }

/* Stores the first `count` lanes: the part of a row that lies outside the image is not written.  Four stores that each have a
 * condition need no branches, and loads neither, so that those of several rows are under way at once. */
void pix_store_clipped(pix v, __global real *row, int count) {
#if LANES == 4
    if (count > 0) row[0] = v.s0;
    if (count > 1) row[1] = v.s1;
    if (count > 2) row[2] = v.s2;
    if (count > 3) row[3] = v.s3;
#else
    if (count >= LANES) {
        PIX_STORE(v, row);
        return;
    }
    real lanes[LANES];
    PIX_STORE(v, lanes);
    for (int i = 0; i < count; i++) row[i] = lanes[i];
#endif
}

/* Loads the first `count` lanes; the others are `other`. */
pix pix_load_or(__global const real *row, int count, real other) {
#if LANES == 4
    return (pix)(count > 0 ? row[0] : other, count > 1 ? row[1] : other, count > 2 ? row[2] : other,
                 count > 3 ? row[3] : other);
#else
    if (count >= LANES) return PIX_LOAD(row);
    real lanes[LANES];
    for (int i = 0; i < LANES; i++) lanes[i] = i < count ? row[i] : other;
    return PIX_LOAD(lanes);
#endif
}

pix pix_load_clipped(__global const real *row, int count) { return pix_load_or(row, count, 0.0f); }

/* 1 in the lanes that lie inside the image, else 0. */
pix pix_inside(int count) { return select((pix)(0.0f), (pix)(1.0f), PIX_MASK(pix_offsets() < (pix)((float)count))); }

/* The cut of Gaussians, as u^2 + v^2. */
#define SUPPORT2 (GSCL_SUPPORT * 1.44269504f)

/* 1.5 * 2^23.  Adding it to y, |y| < 2^22, rounds y to the nearest integer, because a float of that size has no bits after the
 * point.  The sum has to be a float: OpenCL C rounds each operation to its type, and a variable of the type holds the sum. */
#define ROUNDER 12582912.0f

#if EXPONENTIAL == GSCL_EXPONENTIAL_EXACT
pix pix_exp2(pix y) { return exp2(y); }
pix pix_exp2_wide(pix y) { return exp2(y); }
#elif EXPONENTIAL == GSCL_EXPONENTIAL_NATIVE
pix pix_exp2(pix y) { return native_exp2(y); }
pix pix_exp2_wide(pix y) { return native_exp2(y); }
#else
/* 2^y for |y| <= 126.  The low bits of the nearest integer are shifted into the exponent.  The remainder goes through a
 * minimax polynomial on [-1/2, 1/2].  Relative error below 4e-7, no special cases. */
pix pix_exp2_wide(pix y) {
    pix shifted = y + ROUNDER;
    pix r = y - (shifted - ROUNDER);
    pix p = fma((pix)(1.3276472e-3f), r, (pix)(9.6755419e-3f));
    p = fma(p, r, (pix)(5.5507131e-2f));
    p = fma(p, r, (pix)(2.4022120e-1f));
    p = fma(p, r, (pix)(6.9314694e-1f));
    p = fma(p, r, (pix)(1.0000001f));
    return PIX_OF_BITS(PIX_BITS(p) + (PIX_BITS(shifted) << 23));
}

/* 2^y for y in [-SUPPORT2, 0]; smaller y give a value at or below GSCL_WEIGHT_FLOOR. */
pix pix_exp2(pix y) { return pix_exp2_wide(fmax(y, (pix)(-SUPPORT2))); }
#endif

#ifdef DOUBLE
pix pix_cos_turns(pix t) { return cospi(2.0 * t); }
#else
/* cos(2 pi t), |t| < 2^22: folded to a quarter turn of the sine, then a minimax polynomial.  Absolute error below
 * 3e-7 beyond that of t. */
pix pix_cos_turns(pix t) {
    pix shifted = t + ROUNDER;
    pix s = 0.25f - fabs(t - (shifted - ROUNDER)), s2 = s * s;
    pix p = fma((pix)(3.95358124e+01f), s2, (pix)(-7.65496597e+01f));
    p = fma(p, s2, (pix)(8.16009979e+01f));
    p = fma(p, s2, (pix)(-4.13416557e+01f));
    p = fma(p, s2, (pix)(6.28318501e+00f));
    return s * p;
}
#endif

/* A wave of amplitude 1 at a row of pixels: cycles per pixel, and the phase in cycles. */
pix pix_wave(pix dx, real dy, real cycles_x, real cycles_y, real phase) {
    return pix_cos_turns(fma(dx, (pix)(cycles_x), (pix)(fma(dy, cycles_y, -phase))));
}
