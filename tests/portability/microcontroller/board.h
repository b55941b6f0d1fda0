/* A board with a Cortex-M: its start, its memory, a count of instructions, and files of the machine that emulates it. */
#ifndef GSCL_BOARD_H
#define GSCL_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes of variables, and the memory behind them up to the stack, which has STACK_SIZE bytes. */
#define STACK_SIZE 8192u /* multiple of 8 */
size_t board_variables(void);
uint8_t *board_free_memory(size_t *size);

/* Bytes of the stack that were used since the start. */
size_t board_used_stack(void);

/* Instructions since the last call, which QEMU counts with `-icount shift=0`: one takes a nanosecond.  At most 6.7e8, and in
 * steps of 40. */
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
