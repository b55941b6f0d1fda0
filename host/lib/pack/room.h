/* gscl_pack: a field of splats that another program has fitted becomes a file.
 *
 * It may use: encode/ and lower rooms.
 *
 * In the order in which to read them:
 *   pack.c: the stages, from the field to the file
 *   default_settings.c: the settings that the caller leaves
 *   pack_state.h: the state that the stages share
 *   check_field.h: which fields are valid
 *   stored_splats.h: the splats as the format can store them
 *   cut_splat.h: those whose centres are outside the picture
 *   field_rendering.h: the picture that a field is
 *   field_steps.h: the steps of the quantiser, from the finest to the coarsest
 *   pack_target.h: files for a target, without and with rate-distortion passes
 *   tunables.h: numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_PACK_H
#define GSCL_ROOM_LIB_PACK_H
#endif
