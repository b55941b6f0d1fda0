/* gscl_encode: the list of stages, and the searches around it.
 *
 * It may use: all rooms below.
 *
 * In the order in which to read them:
 *   encode.c: the stages of an encode
 *   effect_search.h: effects decided by trial
 *   profile.h: the profile that is used
 *   psnr_search.h: the search for a quality */
#ifndef GSCL_ROOM_LIB_ENCODE_H
#define GSCL_ROOM_LIB_ENCODE_H
#endif
