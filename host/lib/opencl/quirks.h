/* What the library does otherwise for some OpenCL implementations: one table, quirks.c. */
#ifndef GSCL_LIB_QUIRKS_H
#define GSCL_LIB_QUIRKS_H

#include "runtime/mapping.h"

typedef struct gscl_quirks {
    const char *platform;    /* part of the platform's name; NULL: any platform */
    const char *version;     /* part of the platform's version; NULL: any version */
    bool own_builtins;       /* programs declare built-in functions with cl/builtins.h (program.c) */
    bool own_cache;          /* it keeps programs from one process to the next itself (program_cache.h) */
    bool builds_aside;       /* it builds programs while another thread uses the context (prefetch.h) */
    bool software_fma;       /* its fma() is no instruction: kernels multiply and add (cl/macros.h) */
    bool understates_groups; /* it runs kernels in larger work-groups than it says */
    gscl_work_shapes shapes;
} gscl_quirks;

/* The quirks of an implementation, which live for ever.  Never NULL. */
const gscl_quirks *gscl_quirks_find(const char *platform_name, const char *platform_version);

#endif
