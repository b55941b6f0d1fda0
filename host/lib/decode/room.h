/* From bytes to pixels: the coded image, its dequantisation, and the renderer that the fit shares.
 *
 * It may use: software/, image/, runtime/, format/ and cl/.
 *
 * In the order in which to read them:
 *   format_result.h: results of the format
 *   packet_target.h, packet_parts.h, packet_balance.h, packet_split.h: an image in packets
 *   coded_image.h, coded_size.h: bytes to integers and back
 *   dequantise.h, quantise.h: integers to splat parameters and back
 *   blend.h, ycocg.h, ellipse.h: the numbers of blend modes, colours, sizes of splats
 *   renderer.h: splats to pixels on the device
 *   resize.h: drawing at another size
 *   frame.h, frame_message.h: the rectangle that a decode returns, and its limits
 *   output.h: the channels that it returns
 *   draw_progress.h: the caller's callback
 *   draw_device.h: a frame on the device
 *   draw_rows.h: a frame by rows in memory of the caller
 *   decode.h: decoding in another call
 *   decode.c, decode_rows.c, decode_settings.c, packet_repair.c, decoder.c, inspect.c,
 *     read_field.c: the public functions
 *   tunables.h: the numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_DECODE_H
#define GSCL_ROOM_LIB_DECODE_H
#endif
