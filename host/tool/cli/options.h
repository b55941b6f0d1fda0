/* Command-line options described by a table: one parser, one set of range checks and one help text for all
 * subcommands. */
#ifndef GSCL_TOOL_OPTIONS_H
#define GSCL_TOOL_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct option_size {
    uint32_t width, height;
} option_size;

typedef struct option_rectangle {
    uint32_t x, y, width, height;
} option_rectangle;

/* What an option takes, and the type that `value` points to. */
typedef enum option_kind {
    OPTION_FLAG,     /* bool; takes nothing */
    OPTION_TEXT,     /* const char * into argv */
    OPTION_INTEGER,  /* uint64_t in low..high */
    OPTION_REAL,     /* double in minimum..maximum */
    OPTION_WORD,     /* int, an index into `words` */
    OPTION_SIZE,     /* option_size, WIDTHxHEIGHT */
    OPTION_RECTANGLE /* option_rectangle, X,Y,WIDTH,HEIGHT */
} option_kind;

typedef struct option_spec {
    const char *name; /* without the dashes */
    char letter;      /* short form, or 0 */
    option_kind kind;
    void *value; /* written when the option is given */
    bool *given; /* set when the option is given; may be NULL */
    uint64_t low, high;
    double minimum, maximum;
    const char *const *words; /* NULL at the end */
    const char *argument;     /* its name in the help text, "N" */
    const char *help;         /* one phrase, with the default but without the range, which the help adds */
} option_spec;

typedef struct option_command {
    const char *name;  /* "encode" */
    const char *usage; /* "IN... [-o OUT.gscl]" */
    const char *about; /* a few lines on what the command does */
    const option_spec *options;
    int option_count;
    int min_operands, max_operands;
} option_command;

/* What is to happen after parsing. */
typedef enum option_outcome { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_WRONG } option_outcome;

/* Reads argv (argv[0] is the command's name).  OPTIONS_RUN: argv[*first .. argc) are the operands, in number as
 * the command wants them.  OPTIONS_HELP: the help text has been printed.  OPTIONS_WRONG: so has an error. */
option_outcome options_parse(const option_command *command, int argc, char **argv, int *first);

#endif
