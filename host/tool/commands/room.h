/* One file a command of the tool, and what several commands share.
 *
 * It may use: all rooms of the tool.
 *
 * In the order in which to read them:
 *   command.h: the list of commands
 *   command_encode.c, encode_batch.h: encoding one or many images
 *   the other command_*.c
 *   bench_codec.h, effect_list.h, report_json.h, ellipse_outline.h: what they share */
#ifndef GSCL_ROOM_TOOL_COMMANDS_H
#define GSCL_ROOM_TOOL_COMMANDS_H
#endif
