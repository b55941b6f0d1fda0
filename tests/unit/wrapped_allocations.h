/* The linker's names for the allocations of the library, where meson.build redirects them to functions of a test: what a test
 * defines is called in place of malloc and its kind, and calls those of the C library. */
#ifndef GSCL_WRAPPED_ALLOCATIONS_H
#define GSCL_WRAPPED_ALLOCATIONS_H

#include <stddef.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);

#endif
