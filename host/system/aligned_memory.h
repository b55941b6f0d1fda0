/* Memory at multiples of a power of two. */
#ifndef GSCL_SYSTEM_ALIGNED_MEMORY_H
#define GSCL_SYSTEM_ALIGNED_MEMORY_H

#include <stddef.h>

/* To be released with gscl_aligned_free; NULL when out of memory. */
void *gscl_aligned_allocate(size_t alignment, size_t size);
void gscl_aligned_free(void *memory); /* accepts NULL */

#endif
