/* Measurements for gscl/measure.h: speed, accuracy, and what effects cost and gain.
 *
 * It may use: all rooms below.
 *
 * In the order in which to read them:
 *   default_settings.c: the settings that the caller leaves
 *   benchmark.c: the speed of the device and of the kernels
 *   subject.h: a file and its image, which the measurements of accuracy share
 *   reference.h: rendering in double precision
 *   accuracy.c: errors and times of the ways of drawing
 *   decode_error.c: the difference of a decode from double precision
 *   accuracy_quantiser.h: errors and sizes of quantiser steps
 *   accuracy_gradient.c: errors of the fit's derivatives
 *   effect_cost.c: what each effect costs and gains
 *   tunables.h: the numbers that were chosen by trying */
#ifndef GSCL_ROOM_LIB_MEASURE_H
#define GSCL_ROOM_LIB_MEASURE_H
#endif
