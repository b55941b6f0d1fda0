#ifndef GSCL_WEB_INTTYPES_H
#define GSCL_WEB_INTTYPES_H

#include <stdint.h>

#define PRIu32 "u"
#define PRIu64 "llu"

#endif
