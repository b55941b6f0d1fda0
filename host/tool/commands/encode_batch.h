/* Encoding one image or many, on one device or on all. */
#ifndef GSCL_TOOL_ENCODE_BATCH_H
#define GSCL_TOOL_ENCODE_BATCH_H

#include "commands/batch_settings.h"

/* Encodes all inputs, and continues after a failed one.  Returns the exit code of the program. */
int encode_batch_run(const encode_batch *batch);

#endif
