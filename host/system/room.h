/* The operating system, for the library and the tool: no other room asks which one it is.  NAME.h is implemented by NAME_posix.c and
 * NAME_windows.c, and where systems differ more, by NAME_linux.c; meson.build takes one of them.
 *
 * It may use: nothing.
 *
 * In the order in which to read them:
 *   clock.h: a clock
 *   threads.h: threads beside the signals of a program
 *   machine.h: processors and memory
 *   aligned_memory.h: memory for vectors
 *   library.h: libraries that are opened at run time */
#ifndef GSCL_ROOM_SYSTEM_H
#define GSCL_ROOM_SYSTEM_H
#endif
