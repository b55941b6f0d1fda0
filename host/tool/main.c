/* gscl: the command-line tool.  Exit codes: 0 success, 1 failure, 2 wrong usage, 3 some of several images failed, 128 + n
 * ended by signal n. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/memory.h"
#include "cli/message.h"
#include "cli/options.h"
#include "commands/command.h"
#include "host/system/program.h"

typedef struct command {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *about;
} command;

static const command commands[] = {
    {"encode", command_encode, "encode images as gscl files"},
    {"decode", command_decode, "decode a gscl file to an image, at any size, whole or cropped"},
    {"info", command_info, "show the header, the effects and the bits of each stream of a gscl file"},
    {"compare", command_compare, "measure the difference of two images: PSNR, SSIM, MS-SSIM"},
    {"draw", command_draw, "draw the splats of a gscl file as ellipses over the decoded image"},
    {"export", command_export, "write the splats of a gscl file as an SVG image or as a table"},
    {"pack", command_pack, "write splats that another program has fitted as a gscl file"},
    {"devices", command_devices, "list the devices, with the default one and why it is the default"},
    {"bench", command_bench, "measure the speed of this machine: kernels, encode and decode"},
    {"tradeoff", command_tradeoff, "measure accuracy against time, as tables and plots"},
};
#define COMMAND_COUNT (sizeof commands / sizeof *commands)

#define ABOUT "stores an image as 2D Gaussians"
#define ABOUT_FILES                                                                                                   \
    "In place of a file, - reads standard input or\nwrites standard output.  An output appears whole or not at all; " \
    "a symbolic link stays, and the file\nthat it names is written.  Pipes, devices and open descriptors "            \
    "(/dev/stdout, >(...)) are written in place."
#define ABOUT_EXIT_CODE \
    "Exit code: 0 success, 1 failure, 2 wrong usage, 3 some of several images failed, 128 + n signal n."

static void print_usage(FILE *stream) {
    fprintf(stream, "gscl %s: " ABOUT "\n\nusage: gscl COMMAND ...\n\n", gscl_version());
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        fprintf(stream, "  %-10s%s\n", commands[i].name, commands[i].about);
    fprintf(stream, "\n'gscl COMMAND -h' lists a command's options.  " ABOUT_FILES "  " ABOUT_EXIT_CODE "\n");
}

/* ---- Manual pages -------------------------------------------------------------------------------- */

/* The head of a manual page.  `name` is that of a command, or NULL for the program. */
static void print_man_head(const char *name, const char *about) {
    printf(".TH \"GSCL%s", name ? "\\-" : "");
    for (const char *letter = name ? name : ""; *letter; letter++)
        putchar(toupper((unsigned char)*letter));
    printf("\" 1 \"\" \"gscl %s\" \"User Commands\"\n.SH NAME\ngscl%s%s \\- ", gscl_version(), name ? "\\-" : "",
           name ? name : "");
    print_roff(about);
    putchar('\n');
}

/* The manual page of the program.  Those of commands are made by options.c. */
static void print_man(void) {
    print_man_head(NULL, ABOUT);
    fputs(".SH SYNOPSIS\n\\fBgscl\\fR \\fICOMMAND\\fR ...\n.SH DESCRIPTION\n", stdout);
    print_roff(ABOUT_FILES "\n");
    fputs(".SH COMMANDS\n", stdout);
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        printf(".TP\n\\fBgscl\\-%s\\fR(1)\n", commands[i].name);
        print_roff(commands[i].about);
        putchar('\n');
    }
    fputs(".SH EXIT STATUS\n", stdout);
    print_roff(ABOUT_EXIT_CODE "\n");
}

static void print_commands(void) {
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        printf("%s\t%s\n", commands[i].name, commands[i].about);
}

/* ---- Running a command --------------------------------------------------------------------------- */

static const command *find_command(const char *name) {
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(name, commands[i].name) == 0)
            return &commands[i];
    }
    return NULL;
}

static int report_unknown_command(const char *name) {
    return report_usage(name, "is not a command; 'gscl help' lists all commands");
}

static int run_help(int argc, char **argv) {
    if (argc < 2) {
        print_usage(stdout);
        return EXIT_SUCCESS;
    }
    const command *explained = find_command(argv[1]);
    char *arguments[] = {argv[1], "-h", NULL};
    return explained ? explained->run(2, arguments) : report_unknown_command(argv[1]);
}

static bool is_one_of(const char *word, const char *a, const char *b, const char *c) {
    return strcmp(word, a) == 0 || strcmp(word, b) == 0 || strcmp(word, c) == 0;
}

static int run_command(int argc, char **argv) {
    if (argc < 1) {
        print_usage(stderr);
        return EXIT_USAGE;
    }
    if (is_one_of(argv[0], "help", "--help", "-h"))
        return run_help(argc, argv);
    if (is_one_of(argv[0], "--version", "-V", "version")) {
        printf("gscl %s\n", gscl_version());
        return EXIT_SUCCESS;
    }
    if (strcmp(argv[0], "--help=man") == 0) {
        print_man();
        return EXIT_SUCCESS;
    }
    if (strcmp(argv[0], "--help=commands") == 0) {
        print_commands();
        return EXIT_SUCCESS;
    }
    const command *chosen = find_command(argv[0]);
    if (chosen && argc == 2 && strcmp(argv[1], "--help=man") == 0)
        print_man_head(chosen->name, chosen->about);
    return chosen ? chosen->run(argc, argv) : report_unknown_command(argv[0]);
}

int main(int argc, char **argv) {
    system_start_program(&argc, &argv);
    interrupt_install();
    memory_return_freed();
    return finish_stdout(run_command(argc - 1, argv + 1));
}
