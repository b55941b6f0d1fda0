#include "cli/report_json.h"

void report_write_decisions(json_writer *json, const gscl_encode_report *report) {
    json_open_array(json, "effects");
    for (size_t i = 0; i < report->effect_count; i++) {
        const gscl_effect_decision *decision = &report->effects[i];
        json_open_object(json, NULL);
        json_string(json, "name", gscl_effect_name(decision->effect));
        json_bool(json, "on", decision->on);
        json_string(json, "reason", gscl_effect_reason_name(decision->reason));
        json_real(json, "gain_db", decision->gain_db);
        json_close_object(json);
    }
    json_close_array(json);
}

void report_write_stages(json_writer *json, const gscl_encode_report *report) {
    json_open_array(json, "stages");
    for (uint32_t i = 0; i < report->stage_count; i++) {
        json_open_object(json, NULL);
        json_string(json, "name", report->stages[i].name);
        json_integer(json, "count", report->stages[i].count);
        json_real(json, "seconds", report->stages[i].seconds);
        json_close_object(json);
    }
    json_close_array(json);
}

void report_write_trace(json_writer *json, const gscl_encode_report *report) {
    json_open_array(json, "trace");
    for (uint32_t i = 0; i < report->trace_count; i++) {
        const gscl_trace_point *point = &report->trace[i];
        json_open_object(json, NULL);
        json_string(json, "stage", point->stage);
        json_integer(json, "steps", point->steps);
        json_integer(json, "splats", point->splats);
        json_real(json, "seconds", point->seconds);
        json_real(json, "psnr", point->psnr);
        json_close_object(json);
    }
    json_close_array(json);
}
