/* Directions of angles, for all splats of a work-item at once.
 *
 * The built-in sine and cosine are exact for any float, for which some implementations take hundreds of instructions at
 * each call: with them Mesa's compiler took 18 s for a rate-distortion pass with waves, without them 4. */

/* The unit vector (cosine, sine) of an angle. */
typedef struct {
    vfloat x, y;
} unit_vector;

/* An angle without its quarter turns, at most 2^16.  Where fma() rounds the product, the length of a quarter turn has two
 * parts of 8 bits, whose products are exact, and a small one. */
vfloat without_quarters(vfloat angle, vfloat quarters) {
#ifdef SOFTWARE_FMA
    return ((angle - quarters * 1.5703125f) - quarters * 4.82559204e-4f) - quarters * 1.2675908e-6f;
#else
    return fma(quarters, (vfloat)(4.37113883e-8f), fma(quarters, (vfloat)(-1.57079637f), angle));
#endif
}

/* The direction of an angle in radians, |angle| <= 1e5.  The angle without its quarter turns goes through minimax
 * polynomials on [-pi/4, pi/4].  Absolute error below 8e-8, as of the built-in functions. */
unit_vector direction_of(vfloat angle) {
    vfloat quarters = rint(angle * M_2_PI_F);
    vfloat r = without_quarters(angle, quarters), r2 = r * r;
    vfloat p = fma((vfloat)(-1.9515281e-4f), r2, (vfloat)(8.3321603e-3f));
    vfloat q = fma((vfloat)(2.44384501e-5f), r2, (vfloat)(-1.38873677e-3f));
    vfloat sine = fma(r * r2, fma(p, r2, (vfloat)(-1.66666552e-1f)), r);
    vfloat cosine = fma(r2, fma(fma(q, r2, (vfloat)(4.16666456e-2f)), r2, (vfloat)(-0.5f)), (vfloat)(1.0f));
    vint turns = TO_VINT(quarters), is_odd = (turns & 1) != 0;
    unit_vector d;
    d.x = is_odd ? sine : cosine;
    d.y = is_odd ? cosine : sine;
    d.x = ((turns + 1) & 2) != 0 ? -d.x : d.x;
    d.y = (turns & 2) != 0 ? -d.y : d.y;
    return d;
}

/* The direction of a splat's first axis. */
unit_vector axis_direction(vfloat theta) {
    unit_vector along_x = {(vfloat)(1.0f), (vfloat)(0.0f)};
    return ROTATION ? direction_of(theta) : along_x;
}
