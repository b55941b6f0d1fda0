/* The one place where gscl's version is written; the build reads it from here. */
#ifndef GSCL_VERSION_H
#define GSCL_VERSION_H

#define GSCL_VERSION_MAJOR 0
#define GSCL_VERSION_MINOR 1
#define GSCL_VERSION_PATCH 0
#define GSCL_VERSION "0.1.0"

#endif
