/* A board with a Cortex-M: its start, its memory, a count of instructions, and files of the machine that emulates it. */
#ifndef GSCL_BOARD_H
#define GSCL_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define STACK_SIZE 8192u /* bytes, at the end of the memory */

/* Bytes of variables. */
size_t board_variables(void);
/* The memory between variables and stack. */
uint8_t *board_free_memory(size_t *size);
/* Bytes of the stack that were used since the start. */
size_t board_used_stack(void);

/* Begins to count instructions, and returns their number since: at most 6.7e8, in steps of 40.  In QEMU with
 * `-icount shift=0` each takes a nanosecond. */
void board_start_count(void);
uint32_t board_count(void);

/* The words of the command line that follow the name of the program, at most `most`; returns their number. */
int board_words(const char **words, int most);

/* Reads at most `size` bytes of a file; returns their number.  An error ends the program. */
size_t board_read(const char *path, void *bytes, size_t size);
/* Opens a file to be written; writes to it. */
int board_create(const char *path);
void board_write(int file, const void *bytes, size_t size);

/* Prints on standard output. */
void board_print(const char *text);
void board_print_number(const char *name, uint32_t number);

/* Ends the program, with the status 1 unless it was successful. */
void board_exit(bool success);

#endif
