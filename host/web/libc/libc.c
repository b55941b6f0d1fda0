/* What the decoder needs of the C library.  An instance of the decoder serves one call, after which the page drops it with
 * its whole memory: so nothing is freed one by one, and memory is zero when it is given out. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define PAGE 65536u /* bytes, the unit in which memory grows */

extern unsigned char __heap_base; /* by the linker: the first byte that is free */
static size_t heap_end;

static size_t whole_pages(size_t size) {
    return (size + PAGE - 1) / PAGE;
}

void *malloc(size_t size) {
    const size_t begin = heap_end ? heap_end : ((size_t)&__heap_base + 15) & ~(size_t)15;
    const size_t pages = __builtin_wasm_memory_size(0), space = pages * PAGE - begin;
    if (size > SIZE_MAX - begin - PAGE)
        return NULL;
    if (size > space && __builtin_wasm_memory_grow(0, whole_pages(size - space)) == SIZE_MAX)
        return NULL;
    heap_end = (begin + size + 15) & ~(size_t)15;
    return (void *)begin;
}

void *calloc(size_t count, size_t size) {
    return count > 0 && size > SIZE_MAX / count ? NULL : malloc(count * size);
}

/* Of NULL only: what else grows belongs to the writer. */
void *realloc(void *memory, size_t size) {
    return memory ? NULL : malloc(size);
}

void free(void *memory) {
    (void)memory;
}

void *memcpy(void *restrict to, const void *restrict from, size_t size) {
    for (size_t i = 0; i < size; i++)
        ((unsigned char *)to)[i] = ((const unsigned char *)from)[i];
    return to;
}

void *memset(void *to, int byte, size_t size) {
    for (size_t i = 0; i < size; i++)
        ((unsigned char *)to)[i] = (unsigned char)byte;
    return to;
}

int memcmp(const void *a, const void *b, size_t size) {
    const unsigned char *p = a, *q = b;
    size_t i = 0;
    while (i < size && p[i] == q[i])
        i++;
    return i < size ? p[i] - q[i] : 0;
}
