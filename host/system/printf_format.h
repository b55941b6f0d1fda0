/* Formats of printf. */
#ifndef GSCL_SYSTEM_PRINTF_FORMAT_H
#define GSCL_SYSTEM_PRINTF_FORMAT_H

/* Has compilers check printf-style arguments: the numbers of the format and of the first of them.  On Windows stdio.h knows
 * which of two sets of formats is in use: that of C99 is. */
#if defined(__MINGW32__)
#include <stdio.h>
#define GSCL_PRINTF(format_number, first) __attribute__((format(__MINGW_PRINTF_FORMAT, format_number, first)))
#elif defined(__GNUC__)
#define GSCL_PRINTF(format_number, first) __attribute__((format(printf, format_number, first)))
#else
#define GSCL_PRINTF(format_number, first)
#endif

#endif
