/* gscl's version, written here only: the build reads it from this file. */
#ifndef GSCL_VERSION_H
#define GSCL_VERSION_H

#define GSCL_VERSION_MAJOR 1
#define GSCL_VERSION_MINOR 0
#define GSCL_VERSION_PATCH 0
#define GSCL_VERSION "1.0.0"

/* The same as one number, for #if and for comparing with gscl_version_number(): 1002003 is version 1.2.3. */
#define GSCL_VERSION_NUMBER (GSCL_VERSION_MAJOR * 1000000 + GSCL_VERSION_MINOR * 1000 + GSCL_VERSION_PATCH)

#endif
