/* The report of an encode as JSON members. */
#ifndef GSCL_TOOL_REPORT_JSON_H
#define GSCL_TOOL_REPORT_JSON_H

#include <gscl/gscl.h>

#include "cli/json.h"

/* Write arrays into the open object: "effects" (why each is on or off), "stages" and "trace". */
void report_write_decisions(json_writer *json, const gscl_encode_report *report);
void report_write_stages(json_writer *json, const gscl_encode_report *report);
void report_write_trace(json_writer *json, const gscl_encode_report *report);

#endif
