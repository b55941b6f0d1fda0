/* Memory whose size is computed in 64 bits: a size_t of 32 bits cannot count the bytes of the largest image, which are 2^32. */
#ifndef GSCL_LIB_ALLOCATE_H
#define GSCL_LIB_ALLOCATE_H

#include <stdint.h>
#include <stdlib.h>

/* Memory for `count` elements of `size` bytes, to be released with free; NULL when there is too little. */
static inline void *gscl_allocate(uint64_t count, size_t size) {
    return count > SIZE_MAX / size ? NULL : malloc((size_t)count * size);
}

#endif
