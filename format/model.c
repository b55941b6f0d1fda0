#include "format/model.h"

void gsf_model_init(gsf_model *model, const gsf_model_shape *shape, uint16_t *freq, uint32_t count, int32_t centre) {
    const uint32_t width2 = (uint32_t)shape->width * shape->width;
    model->freq = freq;
    model->count = count;
    model->total = 0;
    model->limit = count * shape->mean_limit < GSF_MODEL_MAX_TOTAL ? count * shape->mean_limit : GSF_MODEL_MAX_TOTAL;
    for (int i = 0; i < 3; i++)
        model->gain[i] = shape->gain[i];
    for (uint32_t i = 0; i < count; i++) {
        const int32_t distance = (int32_t)i - centre;
        const uint32_t raised = shape->height * width2 / (width2 + (uint32_t)(distance * distance));
        model->freq[i] = (uint16_t)(shape->base + raised);
        model->total += model->freq[i];
    }
}

static void halve(gsf_model *model) {
    model->total = 0;
    for (uint32_t i = 0; i < model->count; i++) {
        model->freq[i] = (uint16_t)((model->freq[i] + 1) / 2);
        model->total += model->freq[i];
    }
}

void gsf_model_add(gsf_model *model, uint32_t value, uint16_t gain) {
    if (value >= model->count) /* also what wrapped around below zero */
        return;
    model->freq[value] = (uint16_t)(model->freq[value] + gain);
    model->total += gain;
}

void gsf_model_update(gsf_model *model, uint32_t value) {
    gsf_model_add(model, value, model->gain[0]);
    for (uint32_t distance = 1; distance < 3; distance++) {
        gsf_model_add(model, value - distance, model->gain[distance]);
        gsf_model_add(model, value + distance, model->gain[distance]);
    }
    while (model->total > model->limit)
        halve(model);
}

uint32_t gsf_code_with_model(gsf_coder *coder, uint32_t value, gsf_model *model) {
    value = gsf_code_symbol(coder, value, model->freq, model->count, model->total);
    gsf_model_update(model, value);
    return value;
}
