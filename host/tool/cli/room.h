/* Services of every command: options, messages, files, progress, JSON, interrupts.
 *
 * It may use: the operating system (host/system), and the public headers.
 *
 * In the order in which to read them:
 *   options.h, colour_name.h: command lines described by a table
 *   message.h, exit_code.h: errors, notes and the exit code of the program
 *   read_file.h, output_file.h: files and pipes
 *   base64.h, packet_input.h, gscl_input.h: the forms of gscl files
 *   interrupt.h, progress.h: signals and the progress line of a long computation
 *   memory.h: memory that is freed goes back to the system
 *   device_list.h, device_choice.h, pocl_cache.h, build_notice.h: the device of a command
 *   json.h, report_json.h: JSON output
 *   names.h, name_hash.h, rate.h, module.h, stopwatch.h: words for enums, bits per pixel, loaded modules, measured times */
#ifndef GSCL_ROOM_TOOL_CLI_H
#define GSCL_ROOM_TOOL_CLI_H
#endif
