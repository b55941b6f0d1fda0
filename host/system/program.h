/* The start of a program. */
#ifndef GSCL_SYSTEM_PROGRAM_H
#define GSCL_SYSTEM_PROGRAM_H

/* Makes the arguments UTF-8, with slashes in names, and standard input and output binary, and lets the console show UTF-8 and escape
 * sequences: all that is so by itself but on Windows.  Must be called first; the arguments stay for the life of the program. */
void system_start_program(int *argc, char ***argv);

#endif
