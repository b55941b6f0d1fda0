#include "runtime/struct_size.h"

#include <string.h>

#include "runtime/context.h"

static size_t size_of(const void *sized) {
    size_t size;
    memcpy(&size, sized, sizeof size);
    return size;
}

bool gscl_struct_fits(const void *caller, size_t oldest, size_t newest) {
    return size_of(caller) >= oldest && size_of(caller) <= newest;
}

void gscl_struct_copy(const void *caller, void *own, size_t newest) {
    memcpy(own, caller, size_of(caller));
    memcpy(own, &newest, sizeof newest);
}

gscl_result gscl_struct_check(gscl_context *context, const char *type, const void *caller, size_t oldest,
                              size_t newest) {
    const size_t size = size_of(caller);
    if (gscl_struct_fits(caller, oldest, newest))
        return GSCL_OK;
    if (!context)
        return GSCL_ERROR_STRUCT_SIZE;
    if (size == 0)
        return gscl_fail(context, GSCL_ERROR_STRUCT_SIZE,
                         "struct_size of %s is 0: call its _default function or set struct_size to its sizeof", type);
    return gscl_fail(context, GSCL_ERROR_STRUCT_SIZE,
                     "struct_size of %s is %zu, and this library knows %zu to %zu: it was not set, or the program was "
                     "compiled with a newer header",
                     type, size, oldest, newest);
}

gscl_result gscl_struct_read(gscl_context *context, const char *type, const void *caller, size_t oldest, void *own,
                             size_t newest) {
    if (!caller)
        return GSCL_OK;
    GSCL_TRY(gscl_struct_check(context, type, caller, oldest, newest));
    gscl_struct_copy(caller, own, newest);
    return GSCL_OK;
}

void gscl_struct_write(void *caller, const void *own) {
    const size_t size = size_of(caller);
    memcpy((char *)caller + sizeof size, (const char *)own + sizeof size, size - sizeof size);
}

void gscl_struct_init(void *caller, size_t size, const void *own, size_t newest) {
    if (!caller || size < sizeof size)
        return;
    memcpy(caller, own, size < newest ? size : newest);
    memcpy(caller, &size, sizeof size); /* a size that is too large is refused where the struct is read */
}
