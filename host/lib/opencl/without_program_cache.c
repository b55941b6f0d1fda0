/* Windows, whose drivers of OpenCL keep what they have built themselves. */
#include "opencl/program_cache.h"

gscl_result gscl_program_cache_open(gscl_context *context, const char *folder) {
    (void)context, (void)folder;
    return GSCL_OK;
}

void gscl_program_cache_close(gscl_context *context) {
    (void)context;
}

bool gscl_program_key(const gscl_context *context, const char *options, const char *const *texts, const size_t *lengths,
                      size_t count, char bytes[GSCL_PROGRAM_KEY_SIZE]) {
    (void)context, (void)options, (void)texts, (void)lengths, (void)count, (void)bytes;
    return false;
}

cl_program gscl_program_load(const gscl_context *context, const char *key, const char *options) {
    (void)context, (void)key, (void)options;
    return NULL;
}

void gscl_program_save(const gscl_context *context, const char *key, cl_program program) {
    (void)context, (void)key, (void)program;
}
