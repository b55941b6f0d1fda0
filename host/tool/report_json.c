#include "report_json.h"

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

void report_write_rounds(json_writer *json, const gscl_encode_report *report) {
    json_open_array(json, "rounds");
    for (uint32_t i = 0; i < report->round_count; i++) {
        const gscl_round *round = &report->rounds[i];
        json_open_object(json, NULL);
        json_string(json, "stage", round->stage);
        json_integer(json, "steps", round->steps);
        json_integer(json, "splats", round->splats);
        json_real(json, "seconds", round->seconds);
        json_real(json, "psnr", round->psnr);
        json_close_object(json);
    }
    json_close_array(json);
}
