/* Threads that share the work of launches. */
#ifndef GSCL_LIB_NATIVE_POOL_H
#define GSCL_LIB_NATIVE_POOL_H

#include <stddef.h>

#include "runtime/context.h"

typedef struct gscl_pool gscl_pool;

/* Does the items from `first` to before `end`; called by several threads at a time with different items. */
typedef void gscl_pool_work(const void *opaque, size_t first, size_t end);

/* A pool that runs work on `threads` threads, the caller's included.  Threads are started when they are first needed. */
gscl_result gscl_pool_create(gscl_context *context, int threads, gscl_pool **pool);
void gscl_pool_free(gscl_pool *pool); /* accepts NULL */

/* Does all items on at most `threads` threads of the pool, in parts of `part` items, and returns when all have ended.  Where
 * other pools of the process work at the same time, they share its processors: then it takes fewer threads.  A thread that
 * cannot be started is done without.  Returns the number of threads. */
int gscl_pool_run(gscl_pool *pool, int threads, size_t count, size_t part, gscl_pool_work *work, const void *opaque);

#endif
