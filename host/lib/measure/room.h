/* Measurements for gscl/measure.h: speed, accuracy, the value of effects.
 *
 * It may use: all rooms below.
 *
 * In the order in which to read them:
 *   benchmark.c: kernels and the device
 *   subject.h: a file beside its image
 *   accuracy.c, accuracy_quantiser.h, accuracy_gradient.c: errors of each choice
 *   reference.h: the renderer in double precision
 *   effect_cost.c: what each effect costs and gains */
#ifndef GSCL_ROOM_LIB_MEASURE_H
#define GSCL_ROOM_LIB_MEASURE_H
#endif
