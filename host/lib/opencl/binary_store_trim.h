/* Keeping the folder of a binary store small. */
#ifndef GSCL_LIB_BINARY_STORE_TRIM_H
#define GSCL_LIB_BINARY_STORE_TRIM_H

#include <stdint.h>

#define GSCL_BINARY_SUFFIX ".bin"      /* of the names of files that are whole */
#define GSCL_BINARY_UNFINISHED "part-" /* begins the names of files that are being written */

/* Removes the files that were unused for longest until the others take at most `limit` bytes, and what processes that
 * ended too early have left unfinished.  Files of other names stay.  What cannot be removed stays, too. */
void gscl_binary_trim(const char *folder, uint64_t limit);

#endif
