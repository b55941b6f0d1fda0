/* Parses hostile command lines with the tables of all commands, which are not run.  The input is the words of a command
 * line, each on a line of its own; the first names the command.  Every value must then be what it was or in its range, and
 * the operands must be as many as the command takes.  Lists of effects and texts in base64 are read from the words, too. */
#define _DEFAULT_SOURCE /* strdup */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/base64.h"
#include "cli/options.h"
#include "commands/command.h"
#include "commands/effect_list.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Of the linker, for --wrap=options_parse: the tool's function, and what its commands call instead. */
option_outcome __real_options_parse(const option_command *command, int argc, char **argv, int *first);
option_outcome __wrap_options_parse(const option_command *command, int argc, char **argv, int *first);

#define MAX_WORDS 64
#define MAX_VALUE 32 /* bytes; above those of the largest value */

static void require(bool condition, const char *message) {
    if (!condition) {
        fprintf(stderr, "fuzz: %s\n", message);
        abort();
    }
}

/* ---- In place of options_parse ------------------------------------------------------------------- */

static size_t value_size(option_kind kind) {
    static const size_t sizes[] = {[OPTION_FLAG] = sizeof(bool),
                                   [OPTION_TEXT] = sizeof(const char *),
                                   [OPTION_INTEGER] = sizeof(uint64_t),
                                   [OPTION_REAL] = sizeof(double),
                                   [OPTION_WORD] = sizeof(int),
                                   [OPTION_SIZE] = sizeof(option_size),
                                   [OPTION_RECTANGLE] = sizeof(option_rectangle),
                                   [OPTION_SHARE] = sizeof(option_share),
                                   [OPTION_COLOUR] = sizeof(option_colour)};
    return sizes[kind];
}

static int word_count(const option_spec *spec) {
    int count = 0;
    while (spec->words[count])
        count++;
    return count;
}

static bool is_in_range(const option_spec *spec) {
    const void *value = spec->value;
    switch (spec->kind) {
    case OPTION_FLAG:
        return *(const bool *)value;
    case OPTION_TEXT:
        return **(const char *const *)value != '\0';
    case OPTION_INTEGER:
        return *(const uint64_t *)value >= spec->min_integer && *(const uint64_t *)value <= spec->max_integer;
    case OPTION_REAL:
        return *(const double *)value >= spec->min_real && *(const double *)value <= spec->max_real;
    case OPTION_WORD:
        return *(const int *)value >= 0 && *(const int *)value < word_count(spec);
    case OPTION_SIZE: {
        const option_size *size = value;
        return (size->width >= 1 || size->height >= 1) && size->width <= spec->max_integer &&
               size->height <= spec->max_integer; /* a side that is left out is 0 */
    }
    case OPTION_RECTANGLE: {
        const option_rectangle *r = value;
        return r->width >= 1 && r->height >= 1 && r->x <= spec->max_integer && r->y <= spec->max_integer &&
               r->width <= spec->max_integer && r->height <= spec->max_integer;
    }
    case OPTION_SHARE: {
        const option_share *share = value;
        return share->index >= 1 && share->index <= share->count && share->count <= spec->max_integer;
    }
    case OPTION_COLOUR:
        return true;
    }
    return false;
}

/* The values before the command line is parsed. */
static void keep_values(const option_command *command, unsigned char values[][MAX_VALUE]) {
    for (int i = 0; i < command->option_count; i++)
        memcpy(values[i], command->options[i].value, value_size(command->options[i].kind));
}

static void check_values(const option_command *command, unsigned char values[][MAX_VALUE]) {
    for (int i = 0; i < command->option_count; i++) {
        const option_spec *spec = &command->options[i];
        const bool is_changed = memcmp(values[i], spec->value, value_size(spec->kind)) != 0;
        require(!is_changed || is_in_range(spec), "an option has a value outside its range");
        require(!spec->given || !*spec->given || is_in_range(spec),
                "an option is given, but not with a value in its range");
    }
}

option_outcome __wrap_options_parse(const option_command *command, int argc, char **argv, int *first) {
    static unsigned char values[MAX_WORDS][MAX_VALUE];
    require(command->option_count <= MAX_WORDS, "a command has more options than was planned");
    keep_values(command, values);
    const option_outcome outcome = __real_options_parse(command, argc, argv, first);
    if (outcome == OPTIONS_RUN) {
        require(*first >= 1 && *first <= argc, "the operands begin outside the command line");
        require(argc - *first >= command->min_operands && argc - *first <= command->max_operands,
                "a command gets another number of operands than it takes");
        check_values(command, values);
    }
    return outcome == OPTIONS_RUN ? OPTIONS_HELP : outcome; /* the command then ends */
}

/* ---- Values of texts ------------------------------------------------------------------------------ */

static void check_effects(const char *word) {
    uint32_t on = 0, off = 0;
    if (effect_list_parse(word, &on, &off))
        require((on | off) >> GSCL_EFFECT_COUNT == 0 && (on | off) != 0, "an effect is set that does not exist");
}

/* What is decoded from a word gives the same bytes after it was written as text. */
static void check_base64(const char *word) {
    size_t size = strlen(word), length = 0, size_again;
    uint8_t *text = malloc(size + 1);
    require(text != NULL, "no memory");
    memcpy(text, word, size + 1);
    if (!base64_decode(text, &size)) {
        char *line = base64_line(text, size, &length);
        require(line != NULL, "no memory");
        size_again = length;
        require(!base64_decode((uint8_t *)line, &size_again) && size_again == size && memcmp(line, text, size) == 0,
                "base64 changes bytes");
        free(line);
    }
    free(text);
}

/* ---- The target ---------------------------------------------------------------------------------- */

static void run_command(int argc, char **argv) {
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } commands[] = {{"encode", command_encode},    {"decode", command_decode},   {"info", command_info},
                    {"compare", command_compare},  {"draw", command_draw},       {"export", command_export},
                    {"pack", command_pack},        {"devices", command_devices}, {"bench", command_bench},
                    {"tradeoff", command_tradeoff}};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (strcmp(argv[0], commands[i].name) == 0)
            commands[i].run(argc, argv);
}

/* Divides the text into words in its own memory, each with a copy of exactly its length. */
static int split_words(char *text, char **words) {
    int count = 0;
    for (char *line = text, *end; line && count < MAX_WORDS; line = end ? end + 1 : NULL) {
        end = strchr(line, '\n');
        if (end)
            *end = '\0';
        words[count++] = strdup(line);
    }
    words[count] = NULL;
    return count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *words[MAX_WORDS + 1], *permuted[MAX_WORDS + 1];
    char *text = malloc(size + 1);
    require(text != NULL, "no memory");
    memcpy(text, data, size);
    text[size] = '\0';
    const int count = split_words(text, words);
    for (int i = 1; i < count; i++) {
        check_effects(words[i]);
        check_base64(words[i]);
    }
    memcpy(permuted, words, sizeof words); /* getopt sorts them */
    run_command(count, permuted);
    for (int i = 0; i < count; i++)
        free(words[i]);
    free(text);
    return 0;
}
