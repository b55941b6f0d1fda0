/* Public functions that need no context: the version, the text of a result, releasing memory. */
#include <gscl/gscl.h>
#include <stdlib.h>

const char *gscl_version(void) {
    return GSCL_VERSION;
}

uint32_t gscl_version_number(void) {
    return GSCL_VERSION_NUMBER;
}

void gscl_free(void *memory) {
    free(memory);
}

const char *gscl_result_text(gscl_result result) {
    switch (result) {
    case GSCL_OK:
        return "no error";
    case GSCL_ERROR_INVALID_ARGUMENT:
        return "invalid argument";
    case GSCL_ERROR_OUT_OF_MEMORY:
        return "out of memory";
    case GSCL_ERROR_CANCELLED:
        return "cancelled";
    case GSCL_ERROR_STRUCT_SIZE:
        return "struct_size is not set, or is not a size that this library knows";
    case GSCL_ERROR_NO_PLATFORM:
        return "no OpenCL device was found; install an OpenCL implementation such as PoCL";
    case GSCL_ERROR_UNKNOWN_DEVICE:
        return "no such OpenCL device";
    case GSCL_ERROR_AMBIGUOUS_DEVICE:
        return "more than one OpenCL device matches";
    case GSCL_ERROR_DEVICE_MEMORY:
        return "the OpenCL device has too little memory";
    case GSCL_ERROR_DEVICE_FAILED:
        return "an OpenCL call failed";
    case GSCL_ERROR_KERNEL_BUILD:
        return "the OpenCL device could not build the kernels";
    case GSCL_ERROR_NO_ENCODER:
        return "this needs kernels for the processor or an OpenCL device, and the context or the library has neither";
    case GSCL_ERROR_GROUP_SIZE:
        return "the OpenCL device has too small work-groups";
    case GSCL_ERROR_NOT_GSCL:
        return "not a gscl file";
    case GSCL_ERROR_NEWER_VERSION:
        return "written in a newer format version than this program reads";
    case GSCL_ERROR_TRUNCATED:
        return "the file is incomplete";
    case GSCL_ERROR_OTHER_PICTURE:
        return "a packet of another picture";
    case GSCL_ERROR_DAMAGED:
        return "the file is damaged or cut off: the check at its end does not match";
    case GSCL_ERROR_CORRUPT:
        return "the file breaks a rule of the format";
    case GSCL_ERROR_UNKNOWN_BLOCK:
        return "the file has a block that must be understood and is unknown to this program";
    case GSCL_ERROR_LIMIT:
        return "decoding the file would exceed a limit of the settings";
    case GSCL_ERROR_IMAGE_SIZE:
        return "image size outside 1x1 to 16384x16384";
    case GSCL_ERROR_IMAGE_NOT_FINITE:
        return "the image has NaN or infinite samples";
    case GSCL_ERROR_BUDGET_TOO_SMALL:
        return "no file can be that small";
    case GSCL_ERROR_TARGET_UNREACHABLE:
        return "the target quality cannot be reached";
    case GSCL_ERROR_FIELD:
        return "the format does not have such a field of splats";
    case GSCL_ERROR_CONFLICT:
        return "settings that exclude each other";
    }
    return "unknown error";
}
