/* The part of 'gscl tradeoff' that measures the accuracy of the renderer, the quantiser and the gradients. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/progress.h"
#include "tradeoff/tradeoff.h"

#define REPETITIONS 20 /* of each timed run */
#define QUICK_REPETITIONS 5
#define QUICK_EFFORT 1 /* of encodes with other quantiser steps */
#define QUICK_SPLATS 8 /* splats whose derivatives are measured */

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

/* Encodes with the quantiser steps of a row at the fixed size, where finer steps leave room for fewer splats. */
static gscl_result encode_with_steps(const tradeoff_plan *plan, gscl_context *context, tradeoff_accuracy *a) {
    gscl_encode_settings settings;
    gscl_encode_report report = {.struct_size = sizeof report};
    progress_line line;
    uint8_t *bytes;
    size_t size;
    gscl_encode_settings_default(&settings);
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = (double)plan->bytes;
    settings.effort = plan->quick ? QUICK_EFFORT : (int)plan->effort;
    settings.blend = a->row.blend;
    settings.step_factor = a->row.value;
    progress_start(&line, a->variant, false);
    settings.progress = progress_update;
    settings.progress_opaque = &line;
    const gscl_result result = gscl_encode(context, plan->image, &settings, &bytes, &size, &report);
    progress_finish(&line);
    if (result != GSCL_OK)
        return result;
    gscl_free(bytes);
    a->psnr_same_size = report.psnr;
    return GSCL_OK;
}

static gscl_result encode_with_all_steps(const tradeoff_plan *plan, gscl_context *context, tradeoff_results *r) {
    gscl_result result = GSCL_OK;
    for (size_t i = 0; i < r->accuracy_count && result == GSCL_OK; i++)
        if (strcmp(r->accuracies[i].row.choice, "quantiser") == 0 && r->accuracies[i].row.value > 0)
            result = encode_with_steps(plan, context, &r->accuracies[i]);
    return result;
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
    if (result == GSCL_OK)
        result = encode_with_all_steps(plan, context, r);
    const int failed = result == GSCL_OK ? EXIT_SUCCESS : report_result(context, plan->image_name, result);
    gscl_context_free(&context);
    return failed;
}
