/* The inputs of a batch, one after the other: those of the command line, then those of a list, which is read as a stream
 * and never held as a whole. */
#ifndef GSCL_TOOL_INPUT_LIST_H
#define GSCL_TOOL_INPUT_LIST_H

#include <stdbool.h>
#include <stddef.h>

#define INPUT_NAME_SIZE 4096 /* bytes of a name in a list, the NUL included; systems open no longer ones */

typedef struct input_list {
    char *const *operands; /* of the command line */
    int operand_count, next_operand;
    const char *label; /* of the list, in messages */
    int file;          /* -1: no list */
    bool can_restart;  /* whether the same inputs can be read once more: not from standard input and pipes */
    char delimiter;    /* after each name: a line break or NUL */
    char *buffer;
    size_t begin, end; /* bytes of the buffer not yet used */
    char name[INPUT_NAME_SIZE];
    size_t length; /* of the name so far; beyond INPUT_NAME_SIZE - 1 it is cut */
    bool has_nul;  /* within a line */
    bool is_ended;
} input_list;

typedef enum input_state {
    INPUT_NAME, /* there is a name */
    INPUT_WAIT, /* the writer of the list has not sent the next name yet */
    INPUT_END,
    INPUT_ERROR /* the list cannot be read; has been reported */
} input_state;

/* `list_name` may be NULL (no list) or "-" (standard input).  With `null` a NUL ends each name, not a line break.  Reports
 * errors; the caller closes in either case. */
bool input_list_open(input_list *list, char *const *operands, int operand_count, const char *list_name, bool null);
void input_list_close(input_list *list);

/* The next name, valid until the next call.  Empty ones are left out.  *problem is NULL, or says why a name cannot be that
 * of a file. */
input_state input_list_next(input_list *list, const char **name, const char **problem);

/* Waits up to some milliseconds for the writer of the list. */
void input_list_wait(const input_list *list, int milliseconds);

#endif
