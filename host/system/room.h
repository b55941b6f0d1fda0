/* The operating system, for the library and the tool: no other room asks which one it is.  NAME.h is implemented by NAME_posix.c and
 * NAME_windows.c, and where systems differ more, by NAME_linux.c; meson.build takes one of them.
 *
 * It may use: nothing.
 *
 * In the order in which to read them:
 *   clock.h: a clock
 *   printf_format.h: which formats of printf there are
 *   threads.h: threads beside the signals of a program
 *   machine.h: processors and memory
 *   aligned_memory.h: memory for vectors
 *   library.h: libraries that are opened at run time
 *   program.h, signals.h: the start and the end of a program
 *   files.h, output_target.h, temporaries.h: files, and what the names of outputs stand for
 *   text_stream.h: a stream into memory
 *   check_process.h: a function in a process of its own
 *   crash_guard.h: crashes of libraries that read images
 *   windows_names.h: names and errors of Windows, for its files here */
#ifndef GSCL_ROOM_SYSTEM_H
#define GSCL_ROOM_SYSTEM_H
#endif
