/* The tool on Windows: test_windows PROGRAM FILE, in a console.  FILE is a gscl file, of which images are made.
 *
 * All runs in a folder whose name no code page has.  Names of files there are in UTF-16, output is in UTF-8. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>
#include <windows.h>

#define MAX_TEXT 4096                       /* characters of a command line, bytes of what a program prints */
#define MAX_PIPED (1 << 20)                 /* bytes of a file that goes through a pipe */
#define CONSOLE_LINES 20                    /* that are searched for progress */
#define LIMIT_MS (600 * 1000)               /* after which a program hangs */
#define LETTERS L"\x65e5\x672c\xd834\xdd1e" /* two of Japan, and a clef, which takes two units */
#define LETTERS_UTF8 "\xe6\x97\xa5\xe6\x9c\xac\xf0\x9d\x84\x9e"
#define LONG_ENCODE L"encode in.png --device host --effort 9 --bpp 1 -o out.gscl"

static wchar_t program[MAX_PATH], example[MAX_PATH], folder[MAX_PATH];

/* What a program reads and writes; NULL: NUL, but for `error`, whose text is kept in a file. */
typedef struct ends {
    HANDLE input, output, error;
} ends;

static HANDLE open_inherited(const wchar_t *name, DWORD access, DWORD how) {
    SECURITY_ATTRIBUTES inherited = {sizeof inherited, NULL, TRUE};
    const HANDLE handle = CreateFileW(name, access, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited, how, 0, NULL);
    assert_ptr_not_equal(handle, INVALID_HANDLE_VALUE);
    return handle;
}

static HANDLE start(const wchar_t *arguments, const ends *given) {
    wchar_t line[MAX_TEXT] = L"\"";
    wcscat(wcscat(wcscat(line, program), L"\" "), arguments);
    const HANDLE nothing = open_inherited(L"NUL", GENERIC_READ | GENERIC_WRITE, OPEN_EXISTING);
    const HANDLE error = open_inherited(L"error.txt", GENERIC_WRITE, CREATE_ALWAYS);
    STARTUPINFOW startup = {.cb = sizeof startup,
                            .dwFlags = STARTF_USESTDHANDLES,
                            .hStdInput = given && given->input ? given->input : nothing,
                            .hStdOutput = given && given->output ? given->output : nothing,
                            .hStdError = given && given->error ? given->error : error};
    PROCESS_INFORMATION process;
    assert_true(CreateProcessW(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &startup, &process));
    CloseHandle(process.hThread);
    CloseHandle(error);
    CloseHandle(nothing);
    return process.hProcess;
}

static int finish(HANDLE process) {
    DWORD code;
    assert_int_equal(WaitForSingleObject(process, LIMIT_MS), WAIT_OBJECT_0);
    assert_true(GetExitCodeProcess(process, &code));
    CloseHandle(process);
    return (int)code;
}

static int run(const wchar_t *arguments) {
    return finish(start(arguments, NULL));
}

/* Reads a file into `bytes`, and a 0 behind it. */
static size_t read_file(const wchar_t *name, char *bytes, size_t size) {
    FILE *stream = _wfopen(name, L"rb");
    assert_non_null(stream);
    const size_t used = fread(bytes, 1, size - 1, stream);
    bytes[used] = '\0';
    fclose(stream);
    return used;
}

static void write_file(const wchar_t *name, const char *text) {
    FILE *stream = _wfopen(name, L"wb");
    assert_non_null(stream);
    fputs(text, stream);
    fclose(stream);
}

static void assert_holds(const wchar_t *name, const char *text) {
    char bytes[MAX_TEXT];
    read_file(name, bytes, sizeof bytes);
    assert_string_equal(bytes, text);
}

/* Whether what the last program has printed starts so. */
static void assert_message(const char *start) {
    char text[MAX_TEXT];
    read_file(L"error.txt", text, sizeof text);
    text[strlen(start)] = '\0';
    assert_string_equal(text, start);
}

static bool exists(const wchar_t *pattern) {
    WIN32_FIND_DATAW found;
    const HANDLE search = FindFirstFileW(pattern, &found);
    if (search != INVALID_HANDLE_VALUE)
        FindClose(search);
    return search != INVALID_HANDLE_VALUE;
}

/* Starts a long encode in place of out.gscl, and waits until it has opened its output. */
static HANDLE start_long_encode(const ends *given) {
    write_file(L"out.gscl", "old");
    const HANDLE process = start(LONG_ENCODE, given);
    while (!exists(L".gscl-*"))
        assert_int_equal(WaitForSingleObject(process, 10), WAIT_TIMEOUT);
    return process;
}

static void assert_interrupted(HANDLE process) {
    assert_int_equal(finish(process), 128 + SIGINT);
    assert_holds(L"out.gscl", "old");
    assert_false(exists(L".gscl-*"));
}

static void test_interrupt(void **state) {
    (void)state;
    const HANDLE process = start_long_encode(NULL);
    assert_true(GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0));
    assert_interrupted(process);
}

/* The second one does not wait for the encoder. */
static void test_two_interrupts(void **state) {
    (void)state;
    const HANDLE process = start_long_encode(NULL);
    assert_true(GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0));
    assert_true(GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0));
    assert_interrupted(process);
}

/* Opens a file so that others can read it, as most programs do. */
static HANDLE hold(const wchar_t *name) {
    const HANDLE held = CreateFileW(name, GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL);
    assert_ptr_not_equal(held, INVALID_HANDLE_VALUE);
    return held;
}

static void test_output_in_use_at_the_start(void **state) {
    (void)state;
    write_file(L"out.gscl", "old");
    const HANDLE held = hold(L"out.gscl");
    assert_int_equal(run(LONG_ENCODE), EXIT_FAILURE);
    assert_message("gscl: out.gscl: cannot be written: another program has it open\n");
    CloseHandle(held);
    assert_holds(L"out.gscl", "old");
}

static void test_output_in_use_at_the_end(void **state) {
    (void)state;
    write_file(L"out.gscl", "old");
    const HANDLE process = start(L"encode in.png --device host --effort 2 -o out.gscl", NULL);
    while (!exists(L".gscl-*"))
        assert_int_equal(WaitForSingleObject(process, 10), WAIT_TIMEOUT);
    const HANDLE held = hold(L"out.gscl");
    assert_int_equal(finish(process), EXIT_FAILURE);
    assert_message("gscl: out.gscl: cannot be written: another program has it open\n");
    CloseHandle(held);
    assert_holds(L"out.gscl", "old");
    assert_false(exists(L".gscl-*"));
}

static void test_input_in_use(void **state) {
    (void)state;
    write_file(L"held.png", "");
    const HANDLE held = CreateFileW(L"held.png", GENERIC_READ, 0, NULL, OPEN_EXISTING, 0, NULL);
    assert_int_equal(run(L"encode held.png -o other.gscl"), EXIT_FAILURE);
    CloseHandle(held);
    assert_message("gscl: held.png: cannot be opened: another program has it open\n");
}

static void test_names(void **state) {
    (void)state;
    assert_int_equal(run(L"decode in.gscl --size 16x16 -o " LETTERS L".png"), 0);
    assert_true(exists(LETTERS L".png"));
    assert_int_equal(run(L"encode " LETTERS L".png --device host --effort 0 -o a\\..\\" LETTERS L".gscl"), 0);
    assert_true(exists(LETTERS L".gscl"));
    assert_int_equal(run(L"info " LETTERS L"2.gscl"), EXIT_FAILURE);
    assert_message("gscl: " LETTERS_UTF8 "2.gscl: cannot be opened: ");
}

/* Half of a letter of two units is a name for Windows, but no text in UTF-8. */
static void test_name_that_is_no_text(void **state) {
    (void)state;
    assert_int_equal(run(L"decode in.gscl --size 16x16 -o \xd834.png"), 0);
    assert_true(exists(L"\xfffd.png"));
}

static void test_other_case_is_the_same_file(void **state) {
    (void)state;
    assert_int_equal(run(L"encode in.png --device host --effort 0 -o IN.PNG"), 2);
    assert_message("gscl: encode: output IN.PNG would overwrite the input");
}

/* Neither the PNG, whose first bytes are a test of that, nor the gscl file is changed on its way. */
static void test_pipes(void **state) {
    (void)state;
    static char file[MAX_PIPED], piped[MAX_PIPED];
    HANDLE input, input_end, output, output_end;
    assert_true(CreatePipe(&input, &input_end, NULL, MAX_PIPED) && CreatePipe(&output, &output_end, NULL, MAX_PIPED));
    assert_true(SetHandleInformation(input, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT) &&
                SetHandleInformation(output_end, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT));
    const HANDLE process = start(L"decode - -o -", &(ends){.input = input, .output = output_end});
    CloseHandle(input);
    CloseHandle(output_end);
    DWORD done;
    const size_t coded_size = read_file(L"in.gscl", file, sizeof file);
    assert_true(WriteFile(input_end, file, (DWORD)coded_size, &done, NULL) && done == coded_size);
    CloseHandle(input_end);
    assert_int_equal(finish(process), 0);
    size_t used = 0;
    while (ReadFile(output, piped + used, (DWORD)(sizeof piped - used), &done, NULL) && done > 0)
        used += done;
    CloseHandle(output);
    assert_int_equal(run(L"decode in.gscl -o piped.png"), 0);
    assert_int_equal(read_file(L"piped.png", file, sizeof file), used);
    assert_memory_equal(file, piped, used);
}

static void test_closed_pipe(void **state) {
    (void)state;
    HANDLE output, output_end;
    assert_true(CreatePipe(&output, &output_end, NULL, 0));
    assert_true(SetHandleInformation(output_end, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT));
    CloseHandle(output);
    const HANDLE process = start(L"decode in.gscl -o -", &(ends){.output = output_end});
    CloseHandle(output_end);
    assert_int_equal(finish(process), EXIT_FAILURE);
    assert_message("gscl: standard output: cannot be written: ");
}

static HANDLE open_console(void) {
    return open_inherited(L"CONOUT$", GENERIC_READ | GENERIC_WRITE, OPEN_EXISTING);
}

static void test_outputs_that_are_no_files(void **state) {
    (void)state;
    assert_int_equal(run(L"decode in.gscl -o NUL"), 0);
    assert_int_equal(run(L"decode in.gscl -o -"), 0); /* to NUL */
    const HANDLE console = open_console();
    assert_int_equal(finish(start(L"decode in.gscl -o -", &(ends){.output = console})), EXIT_FAILURE);
    CloseHandle(console);
    assert_message("gscl: standard output: is a terminal; ");
}

/* Whether a text is in one of the last lines of the console. */
static bool shows(HANDLE console, const wchar_t *text) {
    CONSOLE_SCREEN_BUFFER_INFO buffer;
    wchar_t line[MAX_TEXT];
    assert_true(GetConsoleScreenBufferInfo(console, &buffer));
    for (int i = 0; i < CONSOLE_LINES && i <= buffer.dwCursorPosition.Y; i++) {
        const COORD from = {0, (SHORT)(buffer.dwCursorPosition.Y - i)};
        DWORD count = 0;
        ReadConsoleOutputCharacterW(console, line, (DWORD)buffer.dwSize.X, from, &count);
        line[count] = L'\0';
        if (wcsstr(line, text))
            return true;
    }
    return false;
}

static void test_progress(void **state) {
    (void)state;
    const HANDLE console = open_console();
    const HANDLE process = start_long_encode(&(ends){.error = console});
    while (!shows(console, L" splats"))
        assert_int_equal(WaitForSingleObject(process, 10), WAIT_TIMEOUT);
    assert_true(GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0));
    assert_interrupted(process);
    assert_true(shows(console, L"gscl: in.png: interrupted"));
    CloseHandle(console);
}

/* Events of the console are for the programs that tests start. */
static BOOL WINAPI ignore_event(DWORD event) {
    (void)event;
    return TRUE;
}

static int enter_folder(void **state) {
    (void)state;
    wchar_t parent[MAX_PATH];
    FILETIME now;
    GetTempPathW(MAX_PATH, parent);
    GetSystemTimeAsFileTime(&now);
    _snwprintf(folder, MAX_PATH, L"%lsgscl-" LETTERS L"-%lu-%lu", parent, GetCurrentProcessId(), now.dwLowDateTime);
    if (!CreateDirectoryW(folder, NULL) || !SetCurrentDirectoryW(folder))
        folder[0] = L'\0'; /* so that leave_folder removes nothing */
    assert_true(folder[0]);
    assert_true(CopyFileW(example, L"in.gscl", FALSE));
    assert_int_equal(run(L"decode in.gscl --size 320x240 -o in.png"), 0);
    return 0;
}

/* cmocka calls it where enter_folder fails, too. */
static int leave_folder(void **state) {
    (void)state;
    wchar_t name[2 * MAX_PATH];
    WIN32_FIND_DATAW found;
    if (!folder[0])
        return 0;
    const HANDLE search = FindFirstFileW(wcscat(wcscpy(name, folder), L"\\*"), &found);
    do
        DeleteFileW(wcscat(wcscat(wcscpy(name, folder), L"\\"), found.cFileName));
    while (FindNextFileW(search, &found));
    FindClose(search);
    SetCurrentDirectoryW(L"..");
    return RemoveDirectoryW(folder) ? 0 : -1;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_interrupt),
        cmocka_unit_test(test_two_interrupts),
        cmocka_unit_test(test_output_in_use_at_the_start),
        cmocka_unit_test(test_output_in_use_at_the_end),
        cmocka_unit_test(test_input_in_use),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_name_that_is_no_text),
        cmocka_unit_test(test_other_case_is_the_same_file),
        cmocka_unit_test(test_pipes),
        cmocka_unit_test(test_closed_pipe),
        cmocka_unit_test(test_outputs_that_are_no_files),
        cmocka_unit_test(test_progress),
    };
    int count;
    wchar_t **arguments = CommandLineToArgvW(GetCommandLineW(), &count);
    SetConsoleCtrlHandler(ignore_event, TRUE);
    if (count != 3 || !GetFullPathNameW(arguments[1], MAX_PATH, program, NULL) ||
        !GetFullPathNameW(arguments[2], MAX_PATH, example, NULL)) {
        fputs("usage: test_windows PROGRAM FILE\n", stderr);
        return 2;
    }
    return cmocka_run_group_tests_name("windows", tests, enter_folder, leave_folder);
}
