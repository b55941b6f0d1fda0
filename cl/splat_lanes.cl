/* Splats side by side: a work-item that projects or updates splats handles SPLAT_LANES of them, one in each lane of
 * its vectors.
 *
 * Build option SPLAT_LANES: 16 on CPUs, where a single splat takes as long as a vector of them; 1 on GPUs, and in
 * programs that process splats one by one.  Bounds in clamp, min and max are vectors too, because Oclgrind evaluates
 * scalar ones wrongly. */
#define SPLAT_ITEMS GSCL_SPLAT_ITEMS(SPLAT_LANES) /* of a group */

#if SPLAT_LANES == 16
typedef float16 vfloat; /* one value per splat */
typedef int16 vint;
#define TO_VINT(x) convert_int16(x)
#define TO_VFLOAT(x) convert_float16(x)
#define LOAD_LANES(p, stride)                                                                                    \
    ((vfloat)((p)[0], (p)[(stride)], (p)[2 * (stride)], (p)[3 * (stride)], (p)[4 * (stride)], (p)[5 * (stride)], \
              (p)[6 * (stride)], (p)[7 * (stride)], (p)[8 * (stride)], (p)[9 * (stride)], (p)[10 * (stride)],    \
              (p)[11 * (stride)], (p)[12 * (stride)], (p)[13 * (stride)], (p)[14 * (stride)], (p)[15 * (stride)]))
#define LOAD_LANES_INT(p) vload16(0, p)
/* The first `n` lanes. */
#define LANES_BELOW(n) ((vint)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15) < (n))
/* 0 in the lanes behind the last of `lanes_used` splats.  An argument that is out of range in one lane
 * makes vector functions take another path for all lanes, with other roundings. */
#define MASK_TAIL(v, lanes_used) select((vfloat)(0.0f), v, LANES_BELOW(lanes_used))
#define OF_TYPE(name, vector, type)                                     \
    void name(vector v, __global type *p, int stride) {                 \
        type lanes[SPLAT_LANES];                                        \
        vstore16(v, 0, lanes);                                          \
        UNROLL                                                          \
        for (int i = 0; i < SPLAT_LANES; i++) p[i * stride] = lanes[i]; \
    }
OF_TYPE(store_lanes, vfloat, float)
OF_TYPE(store_lanes_int, vint, int)
#undef OF_TYPE
#else
typedef float vfloat;
typedef int vint;
#define TO_VINT(x) convert_int(x)
#define TO_VFLOAT(x) convert_float(x)
#define LOAD_LANES(p, stride) ((p)[0])
#define LOAD_LANES_INT(p) (*(p))
#define LANES_BELOW(n) (0 < (n))
#define MASK_TAIL(v, lanes_used) (v)
void store_lanes(vfloat v, __global float *p, int stride) { *p = v; }
void store_lanes_int(vint v, __global int *p, int stride) { *p = v; }
#endif
