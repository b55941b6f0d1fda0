/* Temporary files beside those that they are to replace. */
#ifndef GSCL_SYSTEM_TEMPORARIES_H
#define GSCL_SYSTEM_TEMPORARIES_H

#define TEMPORARY_PATTERN ".gscl-XXXXXX"
#define TEMPORARY_SIZE (sizeof ".gscl-" + 16) /* bytes of a file's name, the NUL included; the pattern is shorter */

/* Opens a temporary file, new or left by a killed process; where another process is writing it, or the file system has no
 * locks, one with a new name, which replaces the last part of `name` (TEMPORARY_SIZE).  -1 with errno on failure. */
int system_make_temporary(char *name);

/* A descriptor that keeps the lock of a temporary file when its own is closed; 0: none. */
int system_keep_lock(int file);

/* Gives a temporary file the permissions of the file that it replaces, or those of a new one. */
void system_take_permissions(int file, const char *target);

/* Removes a temporary file that a killed process has left. */
void system_remove_temporary(const char *name);

#endif
