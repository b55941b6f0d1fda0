#include "decode/format_result.h"

gscl_result gscl_result_of_format(gsf_result result) {
    switch (result) {
    case GSF_OK:
        return GSCL_OK;
    case GSF_NOT_GSCL:
        return GSCL_ERROR_NOT_GSCL;
    case GSF_NEWER_VERSION:
        return GSCL_ERROR_NEWER_VERSION;
    case GSF_TRUNCATED:
        return GSCL_ERROR_TRUNCATED;
    case GSF_DAMAGED:
        return GSCL_ERROR_DAMAGED;
    case GSF_CORRUPT:
        return GSCL_ERROR_CORRUPT;
    case GSF_UNKNOWN_BLOCK:
        return GSCL_ERROR_UNKNOWN_BLOCK;
    case GSF_NO_SPACE:
        return GSCL_ERROR_OUT_OF_MEMORY;
    case GSF_INVALID:
        return GSCL_ERROR_INVALID_ARGUMENT;
    }
    return GSCL_ERROR_CORRUPT;
}
