#include "host/system/program.h"

#include <fcntl.h>
#include <io.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

#include <shellapi.h>

#include "host/system/windows_names.h"

/* The rest of the program knows slashes.  Options, which may hold other text, stay as they are. */
static char *take_argument(const wchar_t *wide) {
    char *argument = system_from_wide(wide);
    for (char *c = argument; c && argument[0] != '-' && *c; c++)
        *c = *c == '\\' ? '/' : *c;
    return argument;
}

static void take_arguments(int *argc, char ***argv) {
    int count = 0;
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &count);
    char **arguments = wide ? calloc((size_t)count + 1, sizeof *arguments) : NULL;
    bool is_whole = arguments != NULL;
    for (int i = 0; is_whole && i < count; i++)
        is_whole = (arguments[i] = take_argument(wide[i])) != NULL;
    LocalFree(wide);
    if (!is_whole)
        return; /* those in the code page of the machine */
    *argc = count;
    *argv = arguments;
}

static void allow_escapes(DWORD which) {
    DWORD mode;
    const HANDLE console = GetStdHandle(which);
    if (GetConsoleMode(console, &mode))
        SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

void system_start_program(int *argc, char ***argv) {
    take_arguments(argc, argv);
    _setmode(_fileno(stdin), _O_BINARY);
    _setmode(_fileno(stdout), _O_BINARY);
    _setmode(_fileno(stderr), _O_BINARY);
    SetConsoleOutputCP(CP_UTF8);
    allow_escapes(STD_OUTPUT_HANDLE);
    allow_escapes(STD_ERROR_HANDLE);
}
