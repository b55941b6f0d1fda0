/* Programs that are kept from one process to the next, as the binaries of the OpenCL implementation.  Implementations that
 * have a cache of their own are left to it.  A cache that cannot be read or written costs time and is never an error. */
#ifndef GSCL_LIB_PROGRAM_CACHE_H
#define GSCL_LIB_PROGRAM_CACHE_H

#include <CL/cl.h>

#include "runtime/context.h"

#define GSCL_PROGRAM_KEY_SIZE 2048 /* bytes, the NUL included */

/* Sets cache_folder of the device to a copy of `folder`, or to NULL where folder is NULL or empty or the implementation of the
 * device has a cache of its own. */
gscl_result gscl_program_cache_open(gscl_context *context, const char *folder);
void gscl_program_cache_close(gscl_context *context);

/* Writes the key of a program, which names all that its binary depends on: device, driver, processor, build options and
 * sources.  Returns false where there is no cache or the device cannot be described. */
bool gscl_program_key(const gscl_context *context, const char *options, const char *const *texts, const size_t *lengths,
                      size_t count, char key[GSCL_PROGRAM_KEY_SIZE]);

/* Returns the program of a key, built with the options; NULL where it must be built from its sources. */
cl_program gscl_program_load(const gscl_context *context, const char *key, const char *options);

/* Stores a program that was built from its sources. */
void gscl_program_save(const gscl_context *context, const char *key, cl_program program);

#endif
