/* The tables of 'gscl tradeoff' on the terminal.  An asterisk marks the default. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/rate.h"
#include "tradeoff/tradeoff_tables.h"

static char mark(bool is_default) {
    return is_default ? '*' : ' ';
}

/* Prints a number, or a dash where it does not apply. */
static void print_real(int width, int decimals, double value, bool applies) {
    if (applies && isfinite(value))
        printf("%*.*f", width, decimals, value);
    else
        printf("%*s", width, "-");
}

static void print_encodes(const tradeoff_encode *rows, size_t count, int default_effort) {
    printf("  effort     bpp  splats   PSNR dB  MS-SSIM  encode s  decode ms\n");
    for (size_t i = 0; i < count; i++) {
        const tradeoff_encode *e = &rows[i];
        printf("%c%7d%8.4f%8u%10.2f", mark(e->effort == default_effort), e->effort, e->bpp, e->report.splats, e->psnr);
        print_real(9, 4, e->ms_ssim, true);
        printf("%10.2f%11.2f\n", e->encode_s, 1e3 * e->decode_s);
    }
}

static void print_accuracy(const tradeoff_accuracy *a) {
    const gscl_accuracy *row = &a->row;
    printf("%c %-13s%-15s%-12s%12.3g%12.3g", mark(row->is_default), row->choice, a->variant, blend_words[row->blend],
           row->largest_error, row->mean_error);
    print_real(10, 3, row->ns_per_pixel, row->ns_per_pixel > 0);
    print_real(9, 2, row->psnr, true);
    print_real(10, 2, row->bits_per_splat, row->bits_per_splat > 0);
    print_real(9, 2, a->psnr_same_size, a->psnr_same_size != 0);
    printf("\n");
}

static void print_gradient(const gscl_gradient_accuracy *g) {
    printf("%c %-12s%-12s%-12s%8u%13.2g%13.2g%11.2f\n", mark(g->is_default), g->kind, g->variant, blend_words[g->blend],
           g->parameters, g->rms_error, g->largest_error, g->ns_per_pixel);
}

void tradeoff_print(const tradeoff_plan *plan, const tradeoff_results *r) {
    printf("%s: %ux%u pixels; %s\n", plan->image_name, plan->image->width, plan->image->height, r->device.device_name);
    printf("\nQuality against encode time, at most %llu bytes (%.4f bits per pixel)\n", (unsigned long long)plan->bytes,
           bits_per_pixel(plan->bytes, plan->image->width, plan->image->height));
    print_encodes(r->efforts, r->effort_count, GSCL_DEFAULT_EFFORT);
    printf("\nQuality against rate, effort %d\n", (int)plan->effort);
    print_encodes(r->rates, r->rate_count, GSCL_DEFAULT_EFFORT);
    printf("\nArithmetic accuracy against time: errors in units of 1/255\n");
    printf("  %-13s%-15s%-12s%12s%12s%10s%9s%10s%9s\n", "choice", "", "blend", "largest", "mean", "ns/pixel", "PSNR dB",
           "bits/splat", "same size");
    for (size_t i = 0; i < r->accuracy_count; i++) {
        if (i > 0 && strcmp(r->accuracies[i].row.choice, r->accuracies[i - 1].row.choice) != 0)
            printf("\n");
        print_accuracy(&r->accuracies[i]);
    }
    printf("\nGradient accuracy against time: relative errors\n");
    printf("  %-12s%-12s%-12s%8s%13s%13s%11s\n", "parameter", "exponential", "blend", "number", "rms", "largest",
           "ns/pixel");
    for (size_t i = 0; i < r->gradient_count; i++)
        print_gradient(&r->gradients[i]);
}
