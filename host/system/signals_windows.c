#include "host/system/signals.h"

#include <signal.h>
#include <windows.h>

static void (*handle_signal)(int number);

/* Called in a thread of its own.  Windows ends the process as soon as it returns from the end of a console. */
static BOOL WINAPI on_control(DWORD event) {
    const BOOL is_key = event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT;
    handle_signal(is_key ? SIGINT : SIGTERM);
    if (!is_key)
        Sleep(INFINITE);
    return TRUE;
}

void system_handle_signals(void (*handle)(int number), void (*end)(int number)) {
    (void)end;
    handle_signal = handle;
    SetConsoleCtrlHandler(on_control, TRUE);
}

int system_is_pipe_signal(int number) {
    (void)number;
    return 0;
}

const char *system_signal_text(int number) {
    return number == SIGINT ? "Interrupt" : number == SIGTERM ? "Terminated" : "Signal";
}
