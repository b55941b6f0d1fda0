/* What the decoder for web pages has in place of the C library.
 *
 * It may use: runtime/elementary.h of the library.
 *
 * In the order in which to read them:
 *   libc.c, stdlib.h, string.h: memory
 *   math.h: functions of numbers
 *   elementary.c: those that the processor has no instructions for
 *   inttypes.h: formats of numbers, which only messages use */
#ifndef GSCL_ROOM_WEB_LIBC_H
#define GSCL_ROOM_WEB_LIBC_H
#endif
