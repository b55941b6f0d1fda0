/* gscl_encode: the list of stages, and the loop around it where the target is a quality.
 *
 * It may use: all rooms below.
 *
 * In the order in which to read them:
 *   encode.c: the stages of an encode
 *   default_settings.c: the settings that the caller leaves
 *   presets.c: targets with an effort, by name
 *   settings.h: which settings are valid
 *   prepare.h: source planes, header, size of the file
 *   repairs.h: how many packets repair others
 *   effect_search.h: which effects the file has
 *   coherence.h: coherence of the directions of edges
 *   quality_search.h: which sizes to try for a quality
 *   tunables.h: numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_ENCODE_H
#define GSCL_ROOM_LIB_ENCODE_H
#endif
