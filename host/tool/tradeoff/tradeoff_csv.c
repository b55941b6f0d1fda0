/* The tables of 'gscl tradeoff' as CSV. */
#include <math.h>
#include <stdio.h>

#include "tradeoff/tradeoff_tables.h"

/* Writes a number, or nothing where it does not apply, and then `end`. */
static void write_real(FILE *stream, double value, bool applies, char end) {
    if (applies && isfinite(value))
        fprintf(stream, "%.9g", value);
    fputc(end, stream);
}

static void write_encodes(const tradeoff_encode *rows, size_t count, FILE *stream) {
    fprintf(stream, "effort,default,bytes,bpp,splats,psnr_db,ms_ssim,encode_s,decode_s\n");
    for (size_t i = 0; i < count; i++) {
        const tradeoff_encode *e = &rows[i];
        fprintf(stream, "%d,%d,%llu,%.6f,%u,", e->effort, e->effort == GSCL_DEFAULT_EFFORT,
                (unsigned long long)e->report.bytes, e->bpp, e->report.splats);
        write_real(stream, e->psnr, true, ',');
        write_real(stream, e->ms_ssim, true, ',');
        fprintf(stream, "%.6f,%.6f\n", e->encode_s, e->decode_s);
    }
}

void tradeoff_write_efforts(const tradeoff_plan *plan, const tradeoff_results *r, FILE *stream) {
    (void)plan;
    write_encodes(r->efforts, r->effort_count, stream);
}

void tradeoff_write_rates(const tradeoff_plan *plan, const tradeoff_results *r, FILE *stream) {
    (void)plan;
    write_encodes(r->rates, r->rate_count, stream);
}

void tradeoff_write_trace(const tradeoff_plan *plan, const tradeoff_results *r, FILE *stream) {
    (void)plan;
    fprintf(stream, "effort,stage,steps,splats,seconds,psnr_db\n");
    for (size_t i = 0; i < r->effort_count; i++)
        for (uint32_t k = 0; k < r->efforts[i].report.trace_count; k++) {
            const gscl_trace_point *point = &r->efforts[i].report.trace[k];
            fprintf(stream, "%d,\"%s\",%u,%u,%.6f,%.6f\n", r->efforts[i].effort, point->stage, point->steps,
                    point->splats, point->seconds, point->psnr);
        }
}

void tradeoff_write_accuracies(const tradeoff_plan *plan, const tradeoff_results *r, FILE *stream) {
    (void)plan;
    fprintf(stream, "choice,variant,value,default,blend,largest_error_255,mean_error_255,ns_per_pixel,psnr_db,"
                    "bits_per_splat,psnr_same_size_db\n");
    for (size_t i = 0; i < r->accuracy_count; i++) {
        const tradeoff_accuracy *a = &r->accuracies[i];
        fprintf(stream, "%s,%s,%.9g,%d,%s,%.9g,%.9g,", a->row.choice, a->variant, a->row.value, a->row.is_default,
                blend_words[a->row.blend], a->row.largest_error, a->row.mean_error);
        write_real(stream, a->row.ns_per_pixel, a->row.ns_per_pixel > 0, ',');
        write_real(stream, a->row.psnr, true, ',');
        write_real(stream, a->row.bits_per_splat, a->row.bits_per_splat > 0, ',');
        write_real(stream, a->psnr_same_size, a->psnr_same_size != 0, '\n');
    }
}

void tradeoff_write_gradients(const tradeoff_plan *plan, const tradeoff_results *r, FILE *stream) {
    (void)plan;
    fprintf(stream, "parameter,exponential,default,blend,parameters,rms_error,largest_error,ns_per_pixel\n");
    for (size_t i = 0; i < r->gradient_count; i++) {
        const gscl_gradient_accuracy *g = &r->gradients[i];
        fprintf(stream, "%s,%s,%d,%s,%u,%.9g,%.9g,%.9g\n", g->kind, g->variant, g->is_default, blend_words[g->blend],
                g->parameters, g->rms_error, g->largest_error, g->ns_per_pixel);
    }
}
