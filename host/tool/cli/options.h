/* Command lines described by a table of options, with one parser, one set of range checks and one form of help text for
 * all commands. */
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

typedef struct option_share {
    uint32_t index, count; /* 1 <= index <= count; 0 when the option is not given */
} option_share;

typedef struct option_colour {
    uint8_t rgb[3];
} option_colour;

/* The kind of value of an option, and the type that `value` points to. */
typedef enum option_kind {
    OPTION_FLAG,      /* bool; no value */
    OPTION_TEXT,      /* const char * into argv */
    OPTION_INTEGER,   /* uint64_t in min_integer..max_integer */
    OPTION_REAL,      /* double in min_real..max_real */
    OPTION_WORD,      /* int, an index into `words` */
    OPTION_SIZE,      /* option_size, WIDTHxHEIGHT, WIDTH or xHEIGHT, each 1..max_integer; 0: left out */
    OPTION_RECTANGLE, /* option_rectangle, X,Y,WIDTH,HEIGHT, each at most max_integer */
    OPTION_SHARE,     /* option_share, I/N, N at most max_integer */
    OPTION_COLOUR     /* option_colour, as colour_name.h says */
} option_kind;

typedef struct option_spec {
    const char *name; /* without the dashes */
    char letter;      /* short form, or 0 */
    option_kind kind;
    void *value; /* written when the option is given */
    bool *given; /* set to true when the option is given; may be NULL */
    uint64_t min_integer, max_integer;
    double min_real, max_real;
    const char *const *words; /* NULL at the end */
    const char *argument;     /* name of the value in the help text, "N" */
    const char *help;         /* one phrase with the default; the help text adds the range */
} option_spec;

typedef struct option_command {
    const char *name;  /* "encode" */
    const char *usage; /* "IN... [-o OUT.gscl]" */
    const char *about; /* what the command does, in a few lines */
    const option_spec *options;
    int option_count;
    int min_operands, max_operands;
} option_command;

/* Outcome of parsing: run the command, or end after the help text or after an error. */
typedef enum option_outcome { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_WRONG } option_outcome;

/* Reads argv (argv[0] is the name of the command).  OPTIONS_RUN: argv[*first .. argc) are the operands, whose number is
 * within the limits of the command.  OPTIONS_HELP: the help text has been printed,
 * or with --help=man or --help=options the same as a part of a manual page or as a table.  OPTIONS_WRONG: an error has. */
option_outcome options_parse(const option_command *command, int argc, char **argv, int *first);

/* Prints text in the language of manual pages, in which some characters have a meaning.  Empty lines separate paragraphs. */
void print_roff(const char *text);

/* The exit code of the program after OPTIONS_HELP or OPTIONS_WRONG. */
int options_exit_code(option_outcome outcome);

#endif
