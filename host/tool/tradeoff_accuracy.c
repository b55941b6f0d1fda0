/* The part of 'gscl tradeoff' that measures what exactness costs. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tradeoff.h"

#define REPETITIONS 20 /* of what is timed */
#define QUICK_REPETITIONS 5
#define QUICK_SPLATS 8 /* whose derivatives are taken */

static void keep_accuracy(void *opaque, const gscl_accuracy *accuracy) {
    tradeoff_results *r = opaque;
    if (r->accuracy_count == TRADEOFF_MAX_ACCURACIES)
        return;
    tradeoff_accuracy *kept = &r->accuracies[r->accuracy_count++];
    kept->row = *accuracy;
    snprintf(kept->variant, sizeof kept->variant, "%s", accuracy->variant);
    kept->row.variant = kept->variant;
}

static void keep_gradient(void *opaque, const gscl_gradient_accuracy *accuracy) {
    tradeoff_results *r = opaque;
    if (r->gradient_count < TRADEOFF_MAX_GRADIENTS)
        r->gradients[r->gradient_count++] = *accuracy; /* its texts are static */
}

/* dB for each doubling of the file, around the fixed size. */
static double slope_of_rates(const tradeoff_plan *plan, const tradeoff_results *r) {
    const double bpp = tradeoff_bpp(plan->image, plan->bytes);
    size_t first = 0, last = r->rate_count - 1;
    while (first + 1 < r->rate_count && r->rates[first + 1].bpp < 0.9 * bpp)
        first++;
    while (last > 0 && r->rates[last - 1].bpp > 1.1 * bpp)
        last--;
    if (last <= first)
        return NAN;
    return (r->rates[last].psnr - r->rates[first].psnr) / log2(r->rates[last].bpp / r->rates[first].bpp);
}

/* Finer steps cost splats: what would be left of the quality with as many bytes as the default steps take. */
static void weigh_quantisers(tradeoff_results *r, double slope) {
    for (size_t i = 0; i < r->accuracy_count; i++) {
        const gscl_accuracy *usual = &r->accuracies[i].row;
        if (strcmp(usual->choice, "quantiser") != 0 || !usual->is_default)
            continue;
        for (size_t k = 0; k < r->accuracy_count; k++) {
            const gscl_accuracy *row = &r->accuracies[k].row;
            if (strcmp(row->choice, "quantiser") == 0 && row->blend == usual->blend && row->bits_per_splat > 0)
                r->accuracies[k].psnr_same_size = row->psnr - slope * log2(row->bits_per_splat / usual->bits_per_splat);
        }
    }
}

int tradeoff_measure_accuracy(const tradeoff_plan *plan, tradeoff_results *r) {
    gscl_context *context;
    gscl_accuracy_settings settings;
    device_choice choice = plan->choice;
    choice.timing = true;
    const int status = open_device(&choice, &context);
    if (status != EXIT_SUCCESS)
        return status;
    gscl_accuracy_settings_default(&settings);
    settings.repetitions = plan->quick ? QUICK_REPETITIONS : REPETITIONS;
    settings.splats = plan->quick ? QUICK_SPLATS : settings.splats;
    gscl_result result = GSCL_OK;
    for (int i = 0; i < TRADEOFF_BLENDS && result == GSCL_OK; i++) {
        result = gscl_measure_accuracy(context, plan->image, r->files[i], r->sizes[i], &settings, keep_accuracy, r);
        if (result == GSCL_OK)
            result =
                gscl_measure_gradients(context, plan->image, r->files[i], r->sizes[i], &settings, keep_gradient, r);
    }
    weigh_quantisers(r, slope_of_rates(plan, r));
    const int failed = result == GSCL_OK ? EXIT_SUCCESS : report_result(context, plan->picture, result);
    gscl_context_free(&context);
    return failed;
}
