/* The tables of 'gscl tradeoff' as JSON. */
#include <math.h>

#include "cli/json.h"
#include "cli/report_json.h"
#include "tradeoff/tradeoff_tables.h"

static void write_encodes(json_writer *json, const char *key, const tradeoff_encode *rows, size_t count) {
    json_open_array(json, key);
    for (size_t i = 0; i < count; i++) {
        const tradeoff_encode *e = &rows[i];
        json_open_object(json, NULL);
        json_integer(json, "effort", (uint64_t)e->effort);
        json_bool(json, "default", e->effort == GSCL_DEFAULT_EFFORT);
        json_integer(json, "bytes", e->report.bytes);
        json_real(json, "bpp", e->bpp);
        json_integer(json, "splats", e->report.splats);
        json_real(json, "psnr", e->psnr);
        json_real(json, "ms_ssim", e->ms_ssim);
        json_real(json, "encode_s", e->encode_s);
        json_real(json, "decode_s", e->decode_s);
        report_write_stages(json, &e->report);
        report_write_trace(json, &e->report);
        json_close_object(json);
    }
    json_close_array(json);
}

static void write_accuracies(json_writer *json, const tradeoff_results *r) {
    json_open_array(json, "accuracy");
    for (size_t i = 0; i < r->accuracy_count; i++) {
        const tradeoff_accuracy *a = &r->accuracies[i];
        json_open_object(json, NULL);
        json_string(json, "choice", a->row.choice);
        json_string(json, "variant", a->variant);
        json_real(json, "value", a->row.value);
        json_bool(json, "default", a->row.is_default);
        json_string(json, "blend", blend_words[a->row.blend]);
        json_real(json, "largest_error_255", a->row.largest_error);
        json_real(json, "mean_error_255", a->row.mean_error);
        json_real(json, "ns_per_pixel", a->row.ns_per_pixel > 0 ? a->row.ns_per_pixel : NAN);
        json_real(json, "psnr", a->row.psnr);
        json_real(json, "bits_per_splat", a->row.bits_per_splat > 0 ? a->row.bits_per_splat : NAN);
        json_real(json, "psnr_same_size", a->psnr_same_size != 0 ? a->psnr_same_size : NAN);
        json_close_object(json);
    }
    json_close_array(json);
}

static void write_gradients(json_writer *json, const tradeoff_results *r) {
    json_open_array(json, "gradients");
    for (size_t i = 0; i < r->gradient_count; i++) {
        const gscl_gradient_accuracy *g = &r->gradients[i];
        json_open_object(json, NULL);
        json_string(json, "parameter", g->kind);
        json_string(json, "exponential", g->variant);
        json_bool(json, "default", g->is_default);
        json_string(json, "blend", blend_words[g->blend]);
        json_integer(json, "parameters", g->parameters);
        json_real(json, "rms_error", g->rms_error);
        json_real(json, "largest_error", g->largest_error);
        json_real(json, "ns_per_pixel", g->ns_per_pixel);
        json_close_object(json);
    }
    json_close_array(json);
}

void tradeoff_write_json(const tradeoff_plan *plan, const tradeoff_results *r, FILE *stream) {
    json_writer json;
    json_start(&json, stream);
    json_open_object(&json, NULL);
    json_string(&json, "image", plan->image_name);
    json_integer(&json, "width", plan->image->width);
    json_integer(&json, "height", plan->image->height);
    json_string(&json, "device", r->device.device_name);
    json_string(&json, "version", r->device.device_version);
    json_integer(&json, "compute_units", r->device.compute_units);
    json_integer(&json, "bytes", plan->bytes);
    json_integer(&json, "effort", plan->effort);
    write_encodes(&json, "quality_time", r->efforts, r->effort_count);
    write_encodes(&json, "quality_rate", r->rates, r->rate_count);
    write_accuracies(&json, r);
    write_gradients(&json, r);
    json_close_object(&json);
}
