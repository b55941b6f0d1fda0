#include "pack/check_field.h"

#include "encode/settings.h"
#include "image/image.h"

/* ---- Settings ---- */

static gscl_result check_target(gscl_context *context, const gscl_pack_settings *s) {
    const double value = s->target_value;
    switch (s->target) {
    case GSCL_TARGET_AUTO:
        return value == 0
                   ? GSCL_OK
                   : gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                               "the target value %.10g has no target; choose one, or 0 for GSCL_TARGET_AUTO", value);
    case GSCL_TARGET_BPP:
    case GSCL_TARGET_BYTES:
    case GSCL_TARGET_PSNR: {
        const double most = s->target == GSCL_TARGET_BPP     ? GSCL_MAX_TARGET_BPP
                            : s->target == GSCL_TARGET_BYTES ? (double)GSCL_MAX_TARGET_BYTES
                                                             : GSCL_MAX_TARGET_PSNR;
        return value >= 0 && value <= most
                   ? GSCL_OK
                   : gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the target %.10g is not in 0..%.0f", value, most);
    }
    default:
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "a field is packed for bits per pixel, bytes or a PSNR, not for another target");
    }
}

static gscl_result check_reference(gscl_context *context, const gscl_field *field, const gscl_image *reference) {
    gscl_content content;
    if (!reference)
        return GSCL_OK;
    GSCL_TRY(gscl_image_examine(context, reference, &content));
    if (reference->width != field->width || reference->height != field->height)
        return gscl_fail(context, GSCL_ERROR_IMAGE_SIZE, "the reference has %ux%u pixels, the field %ux%u",
                         reference->width, reference->height, field->width, field->height);
    if (reference->channels != field->channels)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the reference has %u channels, the field %u",
                         reference->channels, field->channels);
    return GSCL_OK;
}

gscl_result gscl_pack_settings_check(const gscl_packing *p) {
    const gscl_pack_settings *s = &p->settings;
    gscl_context *context = p->context;
    GSCL_TRY(check_target(context, s));
    if (s->refine < 0 || s->refine > GSCL_MAX_REFINE)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "refine %d is not in 0..%d", s->refine, GSCL_MAX_REFINE);
    if (!(s->tolerance >= 0 && s->tolerance <= 1))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the tolerance %g is not in 0..1", s->tolerance);
    if (s->refine > 0 && (s->target == GSCL_TARGET_AUTO || !s->passes || p->field->blend == GSCL_BLEND_ALPHA))
        return gscl_fail(context, GSCL_ERROR_CONFLICT,
                         "to refine takes a target, passes, and another blend than alpha");
    if (s->bare && s->blocks)
        return gscl_fail(context, GSCL_ERROR_CONFLICT, "a bare file cannot have blocks (profile, metadata)");
    GSCL_TRY(gscl_blocks_check(context, s->blocks));
    return check_reference(context, p->field, s->reference);
}

/* ---- The field ---- */

static bool are_steps(const gscl_steps *s) {
    return s->scale <= 15 && s->position <= 15 && s->angle <= 15 && s->luma <= 15 && s->chroma <= 15 &&
           s->alpha <= 15 && s->opacity <= 15 && s->pivot <= GSF_MAX_SCALE_CODE;
}

static gscl_result check_kind(gscl_context *context, const gscl_field *f) {
    if (f->width == 0 || f->height == 0 || f->width > GSCL_MAX_DIMENSION || f->height > GSCL_MAX_DIMENSION)
        return gscl_fail(context, GSCL_ERROR_IMAGE_SIZE, "a field of %ux%u pixels; 1x1 to %dx%d are allowed", f->width,
                         f->height, GSCL_MAX_DIMENSION, GSCL_MAX_DIMENSION);
    if (f->channels < 1 || f->channels > 4)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "a field of %u channels; it must have 1 to 4",
                         f->channels);
    if (f->blend < GSCL_BLEND_NORMALIZED || f->blend > GSCL_BLEND_SUM)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the field's blend is not one of its choices");
    if (f->sample > GSCL_SAMPLE_F32)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the field's sample is not one of its choices");
    if (f->count > 0 && !f->splats)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the field has no splats, but their number");
    if (f->has_steps && !are_steps(&f->steps))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the steps of the field are none; each is 0 to 15, and pivot 0 to 63");
    for (int k = 0; k < 4 && !f->has_mean_background; k++)
        if (!(f->background[k] >= 0 && f->background[k] <= 1))
            return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                             "channel %d of the field's background is %g; it must be 0..1", k,
                             (double)f->background[k]);
    return f->count <= GSCL_MAX_SPLATS
               ? GSCL_OK
               : gscl_fail(context, GSCL_ERROR_FIELD, "the field has %zu splats; the format has at most %d", f->count,
                           GSCL_MAX_SPLATS);
}

/* A number of a splat, and its range.  Beyond these ranges single precision does not draw. */
typedef struct number {
    const char *name;
    double value, least, most;
} number;

#define LARGEST 1e6   /* of all numbers */
#define SMALLEST 1e-6 /* of axes, pixels */

/* Opacities are factors of the colour, weights or parts. */
static number opacity_of(const gscl_splat *s, gscl_blend blend) {
    const double least = blend == GSCL_BLEND_SUM ? -LARGEST : 0, most = blend == GSCL_BLEND_ALPHA ? 1 : LARGEST;
    return (number){"opacity", s->opacity, least, most};
}

/* The first number out of its range; without a name where none is. */
static number fault_of(const gscl_splat *s, gscl_blend blend) {
    const number numbers[] = {{"x", s->x, -LARGEST, LARGEST},
                              {"y", s->y, -LARGEST, LARGEST},
                              {"sigma1", s->sigma1, SMALLEST, LARGEST},
                              {"sigma2", s->sigma2, SMALLEST, LARGEST},
                              {"theta", s->theta, -LARGEST, LARGEST},
                              opacity_of(s, blend),
                              {"red", s->colour[0], -LARGEST, LARGEST},
                              {"green", s->colour[1], -LARGEST, LARGEST},
                              {"blue", s->colour[2], -LARGEST, LARGEST},
                              {"alpha", s->colour[3], -LARGEST, LARGEST},
                              {"wave_x", s->wave_x, -1, 1},
                              {"wave_y", s->wave_y, -1, 1},
                              {"wave_phase", s->wave_phase, -LARGEST, LARGEST},
                              {"wave_amplitude", s->wave_amplitude, -LARGEST, LARGEST},
                              {"layer", s->layer, 0, GSF_MAX_LAYERS - 1}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!(numbers[i].value >= numbers[i].least && numbers[i].value <= numbers[i].most))
            return numbers[i];
    return (number){0};
}

gscl_result gscl_field_check(const gscl_packing *p) {
    const gscl_field *f = p->field;
    GSCL_TRY(check_kind(p->context, f));
    for (size_t i = 0; i < f->count; i++) {
        const number found = fault_of(&f->splats[i], f->blend);
        if (found.name)
            return gscl_fail(p->context, GSCL_ERROR_INVALID_ARGUMENT, "splat %zu: %s is %g; it must be %g to %g", i,
                             found.name, found.value, found.least, found.most);
    }
    return GSCL_OK;
}
