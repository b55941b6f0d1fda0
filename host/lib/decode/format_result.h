/* The library's results for those of the format. */
#ifndef GSCL_LIB_FORMAT_RESULT_H
#define GSCL_LIB_FORMAT_RESULT_H

#include <gscl/gscl.h>

#include "format/types.h"

gscl_result gscl_result_of_format(gsf_result result);

#endif
