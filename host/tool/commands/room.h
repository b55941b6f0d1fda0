/* The subcommands of the tool, one file each, and the parts of single commands.
 *
 * It may use: all rooms of the tool and the public headers.
 *
 * In the order in which to read them:
 *   command.h: the list of commands
 *   command_info.c, command_compare.c, command_devices.c: the short ones
 *   device_check.h: the check of devices
 *   command_decode.c: a gscl file into an image
 *   command_encode.c, effect_list.h, batch_settings.h, encode_batch.h, encode_job.h, batch_devices.h, output_names.h,
 *     packet_files.h: images into gscl files
 *   picture_queue.h, input_list.h, batch_report.h, name_index.h: runs over any number of images
 *   command_draw.c, ellipse_outline.h: splats as ellipses
 *   command_export.c, export_svg.h: splats for other programs
 *   command_pack.c, field_file.h: splats of other programs
 *   command_bench.c, bench_codec.h: the speed of a device
 *   command_tradeoff.c: accuracy against time; its parts are in tradeoff/ */
#ifndef GSCL_ROOM_TOOL_COMMANDS_H
#define GSCL_ROOM_TOOL_COMMANDS_H
#endif
