/* Structs of the public interface that begin with struct_size: how the library reads and writes those of programs that
 * were compiled with an older header (gscl/gscl.h, "How the interface grows"). */
#ifndef GSCL_LIB_STRUCT_SIZE_H
#define GSCL_LIB_STRUCT_SIZE_H

#include <gscl/gscl.h>
#include <stdbool.h>
#include <stddef.h>

/* GSCL_OK when struct_size, the first field of *caller, lies within `oldest`..`newest`; else GSCL_ERROR_STRUCT_SIZE
 * with a message in `context`, which may be NULL. */
gscl_result gscl_struct_check(gscl_context *context, const char *type, const void *caller, size_t oldest,
                              size_t newest);

/* Whether struct_size lies within `oldest`..`newest`. */
bool gscl_struct_fits(const void *caller, size_t oldest, size_t newest);
/* Copies *caller, whose size was checked, over *own, a struct of the library's own size that holds the defaults: fields beyond
 * the caller's size keep them. */
void gscl_struct_copy(const void *caller, void *own, size_t newest);

/* Checks *caller and copies it over *own, a struct of the library's own size that holds the defaults: fields beyond the
 * caller's size keep them.  A NULL `caller` leaves all defaults. */
gscl_result gscl_struct_read(gscl_context *context, const char *type, const void *caller, size_t oldest, void *own,
                             size_t newest);

/* Copies *own to *caller, whose size was checked, up to the caller's size, which it keeps. */
void gscl_struct_write(void *caller, const void *own);

/* Writes *own, a struct of defaults, to a caller's struct of `size` bytes and sets its struct_size. */
void gscl_struct_init(void *caller, size_t size, const void *own, size_t newest);

/* The same with the names and sizes filled in.  `first_new` is the first field that the oldest layout lacks. */
#define GSCL_STRUCT_CHECK(context, type, first_new, caller) \
    gscl_struct_check(context, #type, caller, offsetof(type, first_new), sizeof(type))
#define GSCL_STRUCT_READ(context, type, first_new, caller, own) \
    gscl_struct_read(context, #type, caller, offsetof(type, first_new), own, sizeof(type))
#define GSCL_STRUCT_FITS(type, first_new, caller) gscl_struct_fits(caller, offsetof(type, first_new), sizeof(type))

#endif
