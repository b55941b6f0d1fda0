/* Programs that another thread builds while this one has other work: an encode needs most of its programs later than it
 * knows their options.
 *
 * Of use where the implementation builds a program in some milliseconds from a cache of its own: a fifth of a short encode.
 * Only for implementations that are known to build in a second thread (quirks.h); the calls do nothing for others. */
#ifndef GSCL_LIB_PREFETCH_H
#define GSCL_LIB_PREFETCH_H

#include "runtime/backend.h"

#define GSCL_MAX_PREFETCHED 8

/* Do what gscl_prefetch and gscl_prefetch_end ask for: programs are built in the order in which they were asked for.  Those
 * that the context has are left out, and those beyond GSCL_MAX_PREFETCHED until the end. */
void gscl_opencl_prefetch(gscl_context *context, const gscl_program_request *requests, size_t count);
void gscl_opencl_prefetch_end(gscl_context *context);

/* Waits for a program that was asked for, which the caller owns then.  NULL: it was not, or could not be built. */
struct gscl_program *gscl_opencl_prefetch_take(gscl_context *context, gscl_program_kind kind, const char *options);

#endif
