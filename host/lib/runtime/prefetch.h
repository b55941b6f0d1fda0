/* Programs that another thread builds while this one has other work: an encode needs most of its programs later than it
 * knows their options.
 *
 * Of use where the implementation builds a program in some milliseconds from a cache of its own: a fifth of a short encode.
 * Only for implementations that are known to build in a second thread (quirks.h); the calls do nothing for others. */
#ifndef GSCL_LIB_PREFETCH_H
#define GSCL_LIB_PREFETCH_H

#include "runtime/context.h"
#include "runtime/kernel_options.h"

#define GSCL_MAX_PREFETCHED 8

typedef struct gscl_program_request {
    gscl_program_kind kind;
    gscl_kernel_options options;
} gscl_program_request;

/* Begins to build programs, after those that were asked for before, and in this order.  Those that the context has are left
 * out, and those beyond GSCL_MAX_PREFETCHED until gscl_prefetch_end.  A program that is left out or cannot be built now is
 * built, and its error reported, when it is needed. */
void gscl_prefetch(gscl_context *context, const gscl_program_request *requests, size_t count);

/* Waits for a program that was asked for, which the caller owns then.  NULL: it was not, or could not be built. */
struct gscl_program *gscl_prefetch_take(gscl_context *context, gscl_program_kind kind, const char *options);

/* Waits for the program that is being built; those after it are not built.  The context keeps what was built.  To be called
 * before an encode returns: a process may end then, which an implementation's compiler does not stand. */
void gscl_prefetch_end(gscl_context *context);

#endif
