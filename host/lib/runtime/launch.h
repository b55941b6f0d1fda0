/* Looking kernels up, and launching them. */
#ifndef GSCL_LIB_LAUNCH_H
#define GSCL_LIB_LAUNCH_H

#include "runtime/backend.h"
#include "runtime/buffer.h"

/* Looks a kernel up and, when it is the first kernel of its program, builds the program: one for each combination of source
 * files and options, which the context keeps.  The context owns the kernel, too.  `name` must outlive the context.  Kernels
 * may keep their arguments, so that a context serves one thread only. */
gscl_result gscl_kernel_find(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                             const char *name, gscl_kernel **kernel);

/* Launches `groups` work-groups of `group_size` work-items in one dimension, with arguments 0, 1, ...  Messages name the
 * kernel.  Debug builds check the number of arguments. */
#define GSCL_ARG(x) ((gscl_argument){sizeof(x), &(x)})
#define GSCL_ARG_BUFFER(b) ((gscl_argument){sizeof(void *), &(b).memory})
gscl_result gscl_launch_(gscl_context *context, gscl_kernel *kernel, size_t groups, size_t group_size,
                         const gscl_argument *arguments, size_t count);
#define GSCL_LAUNCH(context, kernel, groups, group_size, ...)                               \
    gscl_launch_(context, kernel, groups, group_size, (const gscl_argument[]){__VA_ARGS__}, \
                 sizeof((const gscl_argument[]){__VA_ARGS__}) / sizeof(gscl_argument))

/* Begins to build programs that are needed later, while this thread has other work: an encode needs most of its programs
 * later than it knows their options.  The implementation decides whether that is of use.  A program that is left out or
 * cannot be built now is built, and its error reported, when it is needed. */
void gscl_prefetch(gscl_context *context, const gscl_program_request *requests, size_t count);
/* Waits for the program that is being built; those after it are not built.  The context keeps what was built.  To be called
 * before an encode returns: a process may end then, which an implementation's compiler does not stand. */
void gscl_prefetch_end(gscl_context *context);

#endif
