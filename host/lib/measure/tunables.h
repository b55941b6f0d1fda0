/* Numbers of the measurements that were chosen by trying.  None of them changes a file or an image. */
#ifndef GSCL_LIB_MEASURE_TUNABLES_H
#define GSCL_LIB_MEASURE_TUNABLES_H

#include <stddef.h>
#include <stdint.h>

struct gscl_measure_tunables {
    /* Speed (benchmark.c, subject.c). */
    uint32_t warm_up_runs;     /* runs that are not counted */
    size_t multiply_add_items; /* work-items of the kernel multiply_add */
    size_t copy_bytes;         /* bytes that the kernel copy reads, and as many that it writes */
    double forward_flop;       /* nominal operations of drawing one splat at one pixel (gscl_measurement) */
    double step_flop;          /* nominal operations of one gradient step for one splat at one pixel */

    /* Accuracy of the derivatives (accuracy_gradient.c). */
    int max_part_side; /* pixels: side of the part of the image in which the loss is differentiated */
    /* Step of the central differences, in the units of the parameters.  Where a single long and narrow splat reaches a
     * pixel, the blend `normalized` changes from the background to the splat's colour within about 1e-5 rad, which a
     * longer step does not resolve. */
    double difference_step;

    /* Accuracy of the quantiser (accuracy_quantiser.c): gradient descent without a quantiser makes the parameters of a
     * file continuous again. */
    int unquantised_steps;
    float unquantised_rate; /* factor on the learning rates */
};

extern const struct gscl_measure_tunables gscl_measure_tunables;

#endif
