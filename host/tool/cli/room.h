/* What every command uses: options, messages, files, progress, JSON, interrupts.
 *
 * It may use: the public headers.
 *
 * In the order in which to read them:
 *   options.h: the option tables
 *   message.h: errors and notes on standard error
 *   read_file.h, output_file.h: files and pipes
 *   interrupt.h, progress.h: a running command
 *   json.h, names.h, device_choice.h, module.h, stopwatch.h: small services */
#ifndef GSCL_ROOM_TOOL_CLI_H
#define GSCL_ROOM_TOOL_CLI_H
#endif
