/* Signals of the system to this process. */
#ifndef GSCL_SYSTEM_SIGNALS_H
#define GSCL_SYSTEM_SIGNALS_H

/* After this call a thread of its own calls `handle` for each signal that asks the program to end, of SIGINT, SIGTERM, SIGHUP, SIGQUIT,
 * SIGALRM, SIGXCPU, SIGUSR1 and SIGUSR2, and on Windows for Ctrl-C, Ctrl-Break and the end of the console or the session, as SIGINT
 * and SIGTERM.  A write to a closed pipe calls `end` from the writing thread (not on Windows, where it is an error of the write, as is a
 * file that grows beyond the limit of the process everywhere).  Must be called before any other thread starts. */
void system_handle_signals(void (*handle)(int number), void (*end)(int number));

/* Whether a number is that of `end` for a closed pipe. */
int system_is_pipe_signal(int number);

/* A few words about a signal. */
const char *system_signal_text(int number);

#endif
