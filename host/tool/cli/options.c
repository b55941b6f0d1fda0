#include "cli/options.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/colour_name.h"
#include "cli/exit_code.h"
#include "cli/message.h"

#define MAX_OPTIONS 48
#define HELP_COLUMN 26 /* where descriptions start */
#define FIRST_LONG 256 /* getopt values of options without a letter; above all characters */

/* ---- Values ------------------------------------------------------------------------------------ */

/* Reads decimal digits, without sign and blanks.  *end is the first character after them. */
static bool read_integer(const char *text, uint64_t *value, const char **end) {
    if (*text < '0' || *text > '9')
        return false;
    char *after;
    errno = 0;
    *value = strtoull(text, &after, 10);
    *end = after;
    return errno == 0;
}

static bool parse_integer(const char *text, uint64_t *value) {
    const char *end;
    return read_integer(text, value, &end) && *end == '\0';
}

static bool parse_real(const char *text, double *value) {
    char *end;
    if (!strchr("0123456789.+-", *text)) /* neither blanks nor "nan" and "inf" */
        return false;
    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

static bool parse_word(const char *text, const char *const *words, int *index) {
    for (int i = 0; words[i]; i++) {
        if (strcmp(text, words[i]) == 0) {
            *index = i;
            return true;
        }
    }
    return false;
}

/* Reads `count` integers of at most `max` with `separator` between them. */
static bool parse_list(const char *text, char separator, uint64_t max, uint32_t *values, int count) {
    for (int i = 0; i < count; i++) {
        uint64_t value;
        if (!read_integer(text, &value, &text) || value > max)
            return false;
        values[i] = (uint32_t)value;
        if (*text != (i + 1 < count ? separator : '\0'))
            return false;
        text++;
    }
    return true;
}

/* One side that is left out is 0. */
static bool parse_size(const option_spec *spec, const char *text, option_size *size) {
    uint32_t values[2] = {0, 0};
    const bool has_both = parse_list(text, 'x', spec->max_integer, values, 2);
    if (!has_both && !parse_list(text, '\0', spec->max_integer, &values[0], 1) &&
        !(*text == 'x' && parse_list(text + 1, '\0', spec->max_integer, &values[1], 1)))
        return false;
    *size = (option_size){values[0], values[1]};
    return has_both ? values[0] > 0 && values[1] > 0 : values[0] > 0 || values[1] > 0;
}

static bool parse_rectangle(const option_spec *spec, const char *text, option_rectangle *rectangle) {
    uint32_t values[4];
    if (!parse_list(text, ',', spec->max_integer, values, 4) || values[2] == 0 || values[3] == 0)
        return false;
    *rectangle = (option_rectangle){values[0], values[1], values[2], values[3]};
    return true;
}

static bool parse_share(const option_spec *spec, const char *text, option_share *share) {
    uint32_t values[2];
    if (!parse_list(text, '/', spec->max_integer, values, 2) || values[0] == 0 || values[0] > values[1])
        return false;
    *share = (option_share){values[0], values[1]};
    return true;
}

static bool parse_value(const option_spec *spec, const char *text) {
    uint64_t integer;
    double real;
    switch (spec->kind) {
    case OPTION_FLAG:
        *(bool *)spec->value = true;
        return true;
    case OPTION_TEXT:
        *(const char **)spec->value = text;
        return *text != '\0';
    case OPTION_INTEGER:
        if (!parse_integer(text, &integer) || integer < spec->min_integer || integer > spec->max_integer)
            return false;
        *(uint64_t *)spec->value = integer;
        return true;
    case OPTION_REAL:
        if (!parse_real(text, &real) || real < spec->min_real || real > spec->max_real)
            return false;
        *(double *)spec->value = real;
        return true;
    case OPTION_WORD:
        return parse_word(text, spec->words, spec->value);
    case OPTION_SIZE:
        return parse_size(spec, text, spec->value);
    case OPTION_RECTANGLE:
        return parse_rectangle(spec, text, spec->value);
    case OPTION_SHARE:
        return parse_share(spec, text, spec->value);
    case OPTION_COLOUR:
        return colour_parse(text, ((option_colour *)spec->value)->rgb);
    }
    return false;
}

/* ---- Descriptions ------------------------------------------------------------------------------ */

static void append_words(char *text, size_t capacity, const char *const *words) {
    for (int i = 0; words[i]; i++) {
        const size_t used = strlen(text);
        snprintf(text + used, capacity - used, "%s%s", i ? ", " : "", words[i]);
    }
}

/* Describes the values of an option, for error messages and for the help text. */
static void describe_range(const option_spec *spec, char *text, size_t capacity) {
    text[0] = '\0';
    switch (spec->kind) {
    case OPTION_INTEGER:
        snprintf(text, capacity, "%" PRIu64 " to %" PRIu64, spec->min_integer, spec->max_integer);
        break;
    case OPTION_REAL:
        snprintf(text, capacity, "%g to %g", spec->min_real, spec->max_real);
        break;
    case OPTION_WORD:
        append_words(text, capacity, spec->words);
        break;
    case OPTION_SIZE:
        snprintf(text, capacity, "1x1 to %" PRIu64 "x%" PRIu64, spec->max_integer, spec->max_integer);
        break;
    case OPTION_RECTANGLE:
        snprintf(text, capacity, "pixels, up to %" PRIu64, spec->max_integer);
        break;
    case OPTION_SHARE:
        snprintf(text, capacity, "1/1 to %" PRIu64 "/%" PRIu64, spec->max_integer, spec->max_integer);
        break;
    case OPTION_COLOUR:
        snprintf(text, capacity, "#rgb, #rrggbb, or a colour name of CSS");
        break;
    case OPTION_FLAG:
    case OPTION_TEXT:
        break;
    }
}

static int report_wrong_value(const char *command, const option_spec *spec, const char *text) {
    static const char *const kinds[] = {
        [OPTION_FLAG] = "",
        [OPTION_TEXT] = "some text",
        [OPTION_INTEGER] = "a whole number from ",
        [OPTION_REAL] = "a number from ",
        [OPTION_WORD] = "one of ",
        [OPTION_SIZE] = "WIDTHxHEIGHT, WIDTH or xHEIGHT from ",
        [OPTION_RECTANGLE] = "X,Y,WIDTH,HEIGHT in ",
        [OPTION_SHARE] = "I/N with I up to N, from ",
        [OPTION_COLOUR] = "",
    };
    char range[256];
    describe_range(spec, range, sizeof range);
    return report_usage(command, "--%s cannot be '%s'; it takes %s%s", spec->name, text, kinds[spec->kind], range);
}

static void print_option(const option_spec *spec) {
    char head[64], range[256];
    describe_range(spec, range, sizeof range);
    if (spec->letter)
        snprintf(head, sizeof head, "  -%c, --%s %s", spec->letter, spec->name, spec->argument ? spec->argument : "");
    else
        snprintf(head, sizeof head, "      --%s %s", spec->name, spec->argument ? spec->argument : "");
    printf("%-*s%s", HELP_COLUMN, head, strlen(head) >= HELP_COLUMN ? " " : "");
    printf("%s%s%s%s\n", spec->help, *range ? " [" : "", range, *range ? "]" : "");
}

static void print_help(const option_command *command) {
    printf("usage: gscl %s %s\n\n%s\n\n", command->name, command->usage, command->about);
    for (int i = 0; i < command->option_count; i++)
        print_option(&command->options[i]);
    printf("%-*s%s\n", HELP_COLUMN, "  -h, --help", "print this text");
}

/* ---- Other forms of the help text -------------------------------------------------------------- */

/* How a character is written that manual pages would otherwise print as a typographic one, which shells do not take; NULL: as it is. */
static const char *roff_escape(char character) {
    switch (character) {
    case '-':
        return "\\-";
    case '\\':
        return "\\e";
    case '\'':
        return "\\(aq";
    case '`':
        return "\\(ga";
    case '^':
        return "\\(ha";
    case '~':
        return "\\(ti";
    default:
        return NULL;
    }
}

void print_roff(const char *text) {
    bool starts_line = true, is_example = false; /* an example is indented, and its lines are not filled */
    for (; *text; text++) {
        const char *escape = roff_escape(*text);
        if (starts_line && is_example != (*text == ' ')) {
            is_example = !is_example;
            fputs(is_example ? ".nf\n" : ".fi\n", stdout);
        }
        if (starts_line && *text == '.')
            fputs("\\&", stdout);
        starts_line = *text == '\n';
        if (text[0] == '\n' && text[1] == '\n') {
            fputs(is_example ? "\n.fi\n.PP\n" : "\n.PP\n", stdout);
            is_example = false;
            text++;
        } else if (escape)
            fputs(escape, stdout);
        else
            putchar(*text);
    }
}

/* A heading of the list of options: "-o, --output FILE". */
static void print_man_option(const option_spec *spec) {
    char range[256];
    describe_range(spec, range, sizeof range);
    fputs(".TP\n", stdout);
    if (spec->letter)
        printf("\\fB\\-%c\\fR, ", spec->letter);
    fputs("\\fB\\-\\-", stdout);
    print_roff(spec->name);
    fputs("\\fR", stdout);
    if (spec->argument)
        printf(" \\fI%s\\fR", spec->argument);
    putchar('\n');
    print_roff(spec->help);
    if (*range) {
        fputs(" [", stdout);
        print_roff(range);
        putchar(']');
    }
    putchar('\n');
}

/* The manual page after its section NAME, which the program prints. */
static void print_man(const option_command *command) {
    fputs(".SH SYNOPSIS\n\\fBgscl ", stdout);
    print_roff(command->name);
    fputs("\\fR ", stdout);
    print_roff(command->usage);
    fputs("\n.SH DESCRIPTION\n", stdout);
    print_roff(command->about);
    fputs("\n.SH OPTIONS\n", stdout);
    for (int i = 0; i < command->option_count; i++)
        print_man_option(&command->options[i]);
    fputs(".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nprint a help text\n", stdout);
}

/* One line for each option, for scripts that complete command lines, with tabs between: name, letter, name of the value (empty
 * for flags), words that it can be, help. */
static void print_option_table(const option_command *command) {
    for (int i = 0; i < command->option_count; i++) {
        const option_spec *spec = &command->options[i];
        char words[256] = "";
        if (spec->kind == OPTION_WORD)
            append_words(words, sizeof words, spec->words);
        printf("%s\t%.1s\t%s\t%s\t%s\n", spec->name, &spec->letter, spec->argument ? spec->argument : "", words,
               spec->help);
    }
}

/* Prints the help text, or for --help=FORM another form of it. */
static option_outcome run_help(const option_command *command, const char *form) {
    if (!form)
        print_help(command);
    else if (strcmp(form, "man") == 0)
        print_man(command);
    else if (strcmp(form, "options") == 0)
        print_option_table(command);
    else {
        report_usage(command->name, "--help cannot be '%s'; it takes man or options", form);
        return OPTIONS_WRONG;
    }
    return OPTIONS_HELP;
}

/* ---- The command line -------------------------------------------------------------------------- */

/* The options of a command in the tables of getopt. */
typedef struct getopt_tables {
    struct option longs[MAX_OPTIONS + 2];
    char shorts[2 * MAX_OPTIONS + 3];
} getopt_tables;

static void fill_getopt_tables(const option_command *command, getopt_tables *tables) {
    char *letter = tables->shorts;
    memset(tables, 0, sizeof *tables);
    *letter++ = ':'; /* getopt then returns ':' for a missing argument and '?' for an unknown option */
    *letter++ = 'h';
    tables->longs[0] = (struct option){"help", optional_argument, NULL, 'h'};
    for (int i = 0; i < command->option_count && i < MAX_OPTIONS; i++) {
        const option_spec *spec = &command->options[i];
        const int argument = spec->kind == OPTION_FLAG ? no_argument : required_argument;
        tables->longs[i + 1] = (struct option){spec->name, argument, NULL, FIRST_LONG + i};
        if (spec->letter) {
            *letter++ = spec->letter;
            if (argument == required_argument)
                *letter++ = ':';
        }
    }
}

/* The option of a return value of getopt. */
static const option_spec *find_option(const option_command *command, int value) {
    for (int i = 0; i < command->option_count; i++) {
        if (value == FIRST_LONG + i || (value < FIRST_LONG && value == command->options[i].letter))
            return &command->options[i];
    }
    return NULL;
}

static int report_unknown_option(const option_command *command, char **argv, bool argument_missing) {
    char letter[3] = {'-', (char)optopt, '\0'};
    /* For a short option getopt sets optopt to its letter; for a long one, to another value. */
    const bool is_short = optopt > 0 && optopt < FIRST_LONG;
    const char *name = is_short ? letter : argv[optind - 1];
    if (argument_missing)
        return report_usage(command->name, "%s lacks its value; 'gscl %s -h' explains it", name, command->name);
    return report_usage(command->name, "unknown option %s; 'gscl %s -h' lists all", name, command->name);
}

static bool check_operand_count(const option_command *command, int count) {
    if (count >= command->min_operands && count <= command->max_operands)
        return true;
    report_usage(command->name, "%s; usage: gscl %s %s",
                 count < command->min_operands ? "an input is missing" : "too many inputs", command->name,
                 command->usage);
    return false;
}

option_outcome options_parse(const option_command *command, int argc, char **argv, int *first) {
    getopt_tables tables;
    fill_getopt_tables(command, &tables);
    opterr = 0;
    optind = 0; /* the C library then forgets a command line whose parsing ended early */
    for (int value; (value = getopt_long(argc, argv, tables.shorts, tables.longs, NULL)) != -1;) {
        if (value == 'h')
            return run_help(command, optarg);
        const option_spec *spec = find_option(command, value);
        if (!spec) {
            report_unknown_option(command, argv, value == ':');
            return OPTIONS_WRONG;
        }
        if (!parse_value(spec, optarg)) {
            report_wrong_value(command->name, spec, optarg);
            return OPTIONS_WRONG;
        }
        if (spec->given)
            *spec->given = true;
    }
    *first = optind;
    return check_operand_count(command, argc - optind) ? OPTIONS_RUN : OPTIONS_WRONG;
}

int options_exit_code(option_outcome outcome) {
    return outcome == OPTIONS_HELP ? EXIT_SUCCESS : EXIT_USAGE;
}
