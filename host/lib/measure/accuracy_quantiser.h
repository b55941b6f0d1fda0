/* The measurement of accuracy that varies the quantiser. */
#ifndef GSCL_LIB_ACCURACY_QUANTISER_H
#define GSCL_LIB_ACCURACY_QUANTISER_H

#include "measure/subject.h"

/* The choice "quantiser" (accuracy_quantiser.c). */
gscl_result gscl_measure_quantiser(gscl_subject *subject, gscl_accuracy_callback callback, void *opaque);

#endif
