/* What the decoder for web pages has in place of the C library.
 *
 * It uses nothing else.
 *
 * In the order in which to read them:
 *   libc.c, stdlib.h, string.h: memory
 *   math.h: functions of numbers
 *   inttypes.h: formats of numbers, which only messages use */
#ifndef GSCL_ROOM_WEB_LIBC_H
#define GSCL_ROOM_WEB_LIBC_H
#endif
