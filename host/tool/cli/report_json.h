/* The report of an encode as JSON members. */
#ifndef GSCL_TOOL_REPORT_JSON_H
#define GSCL_TOOL_REPORT_JSON_H

#include <gscl/gscl.h>

#include "cli/json.h"

/* Write the arrays "stages" and "trace" into the open object. */
void report_write_stages(json_writer *json, const gscl_encode_report *report);
void report_write_trace(json_writer *json, const gscl_encode_report *report);

#endif
