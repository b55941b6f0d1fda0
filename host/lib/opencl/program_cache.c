#include "opencl/program_cache.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "opencl/binary_store.h"
#include "opencl/library.h"
#include "opencl/opencl_device.h"
#include "opencl/tunables.h"
#include "runtime/text.h"

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

#define MAX_INFO 256 /* bytes of a text that describes a device, the NUL included */

gscl_result gscl_program_cache_open(gscl_context *context, const char *folder) {
    if (!folder || !*folder || gscl_opencl(context)->quirks->own_cache)
        return GSCL_OK;
    const size_t size = strlen(folder) + 1;
    gscl_opencl(context)->cache_folder = malloc(size);
    if (!gscl_opencl(context)->cache_folder)
        return gscl_fail_memory(context);
    memcpy(gscl_opencl(context)->cache_folder, folder, size);
    return GSCL_OK;
}

void gscl_program_cache_close(gscl_context *context) {
    free(gscl_opencl(context)->cache_folder);
    gscl_opencl(context)->cache_folder = NULL;
}

/* ---- Keys -------------------------------------------------------------------------------------- */

/* Appends the processor's features: a folder may be shared by machines whose processors have one name, and binaries of a
 * CPU use whatever instructions there are. */
static void append_processor(gscl_text *key) {
#if defined(__x86_64__) || defined(__i386__)
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (__get_cpuid(1, &a, &b, &c, &d))
        gscl_text_append(key, "processor %08x %08x %08x", a, c & ~(1u << 27), d); /* less OSXSAVE */
    if (__get_cpuid_count(7, 0, &a, &b, &c, &d))
        gscl_text_append(key, " %08x %08x %08x", b, c & ~(1u << 4), d); /* less OSPKE */
    gscl_text_append(key, "\n");
#else
    (void)key;
#endif
}

/* Appends what the platform and the device say of themselves.  Returns false where they do not. */
static bool append_device(gscl_text *key, const gscl_context *context) {
    static const cl_platform_info platform[] = {CL_PLATFORM_NAME, CL_PLATFORM_VERSION};
    static const cl_device_info device[] = {CL_DEVICE_NAME, CL_DEVICE_VENDOR, CL_DEVICE_VERSION, CL_DRIVER_VERSION};
    char text[MAX_INFO];
    for (size_t i = 0; i < sizeof platform / sizeof *platform; i++) {
        if (gscl_cl.clGetPlatformInfo(gscl_opencl(context)->platform, platform[i], sizeof text, text, NULL) !=
            CL_SUCCESS)
            return false;
        gscl_text_append(key, "platform %s\n", text);
    }
    for (size_t i = 0; i < sizeof device / sizeof *device; i++) {
        if (gscl_cl.clGetDeviceInfo(gscl_opencl(context)->id, device[i], sizeof text, text, NULL) != CL_SUCCESS)
            return false;
        gscl_text_append(key, "device %s\n", text);
    }
    if (context->is_cpu)
        append_processor(key);
    return true;
}

bool gscl_program_key(const gscl_context *context, const char *options, const char *const *texts, const size_t *lengths,
                      size_t count, char bytes[GSCL_PROGRAM_KEY_SIZE]) {
    if (!gscl_opencl(context)->cache_folder)
        return false;
    gscl_text key = gscl_text_begin(bytes, GSCL_PROGRAM_KEY_SIZE);
    gscl_text_append(&key, "gscl " GSCL_VERSION "\noptions %s\n", options);
    if (!append_device(&key, context))
        return false;
    uint64_t hash = GSCL_HASH_START;
    for (size_t i = 0; i < count; i++)
        hash = gscl_hash(hash, texts[i], lengths[i] + 1); /* the NUL marks the end of a file */
    gscl_text_append(&key, "sources %016" PRIx64 "\n", hash);
    return !key.overflow;
}

/* ---- Binaries ---------------------------------------------------------------------------------- */

static cl_program program_from_binary(const gscl_context *context, const unsigned char *binary, size_t size,
                                      const char *options) {
    cl_int status = CL_SUCCESS, error;
    cl_program program = gscl_cl.clCreateProgramWithBinary(gscl_opencl(context)->context, 1, &gscl_opencl(context)->id,
                                                           &size, &binary, &status, &error);
    if (error != CL_SUCCESS)
        return NULL;
    if (status == CL_SUCCESS &&
        gscl_cl.clBuildProgram(program, 1, &gscl_opencl(context)->id, options, NULL, NULL) == CL_SUCCESS)
        return program;
    gscl_cl.clReleaseProgram(program);
    return NULL;
}

cl_program gscl_program_load(const gscl_context *context, const char *key, const char *options) {
    size_t size;
    void *binary = gscl_binary_load(gscl_opencl(context)->cache_folder, key, gscl_opencl_tunables.cache_bytes, &size);
    cl_program program = binary ? program_from_binary(context, binary, size, options) : NULL;
    if (binary && !program)
        gscl_log(context, GSCL_LOG_INFO, "%s does not take its own binary", context->info.device_name);
    free(binary);
    return program;
}

/* The binary of a program, to be freed; NULL where the implementation gives none. */
static unsigned char *program_binary(cl_program program, size_t *size) {
    *size = 0;
    if (gscl_cl.clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof *size, size, NULL) != CL_SUCCESS ||
        *size == 0 || *size > gscl_opencl_tunables.cache_bytes)
        return NULL;
    unsigned char *binary = malloc(*size);
    if (binary && gscl_cl.clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof binary, &binary, NULL) == CL_SUCCESS)
        return binary;
    free(binary);
    return NULL;
}

void gscl_program_save(const gscl_context *context, const char *key, cl_program program) {
    size_t size;
    unsigned char *binary = program_binary(program, &size);
    if (!binary)
        return;
    const int error =
        gscl_binary_save(gscl_opencl(context)->cache_folder, key, binary, size, gscl_opencl_tunables.cache_bytes);
    if (error != 0)
        gscl_log(context, GSCL_LOG_WARNING, "%s cannot keep built kernels: %s", gscl_opencl(context)->cache_folder,
                 strerror(error));
    free(binary);
}
