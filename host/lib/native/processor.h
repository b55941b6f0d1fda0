/* The kernels for the processor that this is. */
#ifndef GSCL_LIB_NATIVE_PROCESSOR_H
#define GSCL_LIB_NATIVE_PROCESSOR_H

#include "native/programs.h"

/* The first entry of gscl_native_processors whose instructions this processor and its operating system have; NULL: none. */
const gscl_native_processor *gscl_native_processor_choose(void);

/* Whether this processor can run the kernels of an entry. */
bool gscl_native_processor_runs(const gscl_native_processor *processor);

/* For tests: makes gscl_native_processor_choose return the entry of this name; NULL: by the processor again.  Returns whether
 * the library has such kernels and this processor runs them. */
bool gscl_native_processor_force(const char *name);

#endif
