/* The frame of a decode in a context, which has a message where it fails. */
#ifndef GSCL_LIB_FRAME_MESSAGE_H
#define GSCL_LIB_FRAME_MESSAGE_H

#include "decode/output.h"

/* Checks what gscl_output_is_possible does. */
gscl_result gscl_output_check(gscl_context *context, const gscl_decode_settings *s);

/* As gscl_frame_resolve. */
gscl_result gscl_frame_resolve_for(gscl_context *context, const gscl_decode_settings *s, const gsf_header *header,
                                   gscl_frame *f);

/* Checks the work against max_work. */
gscl_result gscl_frame_check_work(gscl_context *context, const gscl_decode_settings *s, const gsf_coded_image *coded,
                                  const gscl_frame *f);

#endif
