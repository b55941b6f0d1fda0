/* Names for functions of Windows, and what their failures are for the C library: for the files *_windows.c. */
#ifndef GSCL_SYSTEM_WINDOWS_NAMES_H
#define GSCL_SYSTEM_WINDOWS_NAMES_H

#include <wchar.h>

/* A text in UTF-8 as UTF-16, or the other way, to be released with free; NULL with errno where it is none, and when out of
 * memory. */
wchar_t *system_to_wide(const char *text);
char *system_from_wide(const wchar_t *text);

/* Sets errno by GetLastError. */
void system_take_error(void);

#endif
