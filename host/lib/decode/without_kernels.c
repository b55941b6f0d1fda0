/* What a library with neither OpenCL nor compiled kernels (meson setup -Dopencl=disabled -Dnative=disabled) has in place of
 * draw_device.c and of the rooms above: its contexts are those of the device "host", which only decodes. */
#include <gscl/measure.h>

#include "decode/draw_device.h"
#include "runtime/context.h"

static gscl_result refuse(gscl_context *context, const char *activity) {
    gscl_forget_message(context);
    return context ? gscl_require_encoder(context, activity) : GSCL_ERROR_INVALID_ARGUMENT;
}

/* Every context that is open is that of the device "host", which draws in software. */
gscl_result gscl_draw_on_device(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                                const gscl_output *o, const gscl_draw_progress *progress) {
    (void)coded, (void)f, (void)o, (void)progress;
    return gscl_require_encoder(context, "drawing");
}

gscl_result gscl_compare(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison) {
    (void)a, (void)b, (void)comparison;
    return GSCL_ERROR_NO_ENCODER;
}

gscl_result gscl_encode(gscl_context *context, const gscl_image *image, const gscl_encode_settings *settings,
                        uint8_t **bytes, size_t *size, gscl_encode_report *report) {
    (void)image, (void)settings, (void)bytes, (void)size, (void)report;
    return refuse(context, "encoding");
}

gscl_result gscl_pack(gscl_context *context, const gscl_field *field, const gscl_pack_settings *settings,
                      uint8_t **bytes, size_t *size, gscl_pack_report *report) {
    (void)field, (void)settings, (void)bytes, (void)size, (void)report;
    return refuse(context, "packing");
}

gscl_result gscl_inspect_effects(gscl_context *context, const uint8_t *bytes, size_t size,
                                 const gscl_read_settings *settings, const gscl_image *image, gscl_effect_use *uses,
                                 size_t *count) {
    (void)bytes, (void)size, (void)settings, (void)image, (void)uses, (void)count;
    return context ? refuse(context, "measuring effects") : GSCL_ERROR_NO_ENCODER;
}

gscl_result gscl_benchmark_device(gscl_context *context, const gscl_benchmark_settings *settings,
                                  gscl_measurement_callback callback, void *opaque) {
    (void)settings, (void)callback, (void)opaque;
    return refuse(context, "a benchmark");
}

gscl_result gscl_benchmark_kernels(gscl_context *context, const gscl_benchmark_settings *settings,
                                   gscl_measurement_callback callback, void *opaque) {
    (void)settings, (void)callback, (void)opaque;
    return refuse(context, "a benchmark");
}

gscl_result gscl_measure_accuracy(gscl_context *context, const gscl_image *image, const uint8_t *bytes, size_t size,
                                  const gscl_accuracy_settings *settings, gscl_accuracy_callback callback,
                                  void *opaque) {
    (void)image, (void)bytes, (void)size, (void)settings, (void)callback, (void)opaque;
    return refuse(context, "measuring accuracy");
}

gscl_result gscl_measure_gradients(gscl_context *context, const gscl_image *image, const uint8_t *bytes, size_t size,
                                   const gscl_accuracy_settings *settings, gscl_gradient_callback callback,
                                   void *opaque) {
    (void)image, (void)bytes, (void)size, (void)settings, (void)callback, (void)opaque;
    return refuse(context, "measuring accuracy");
}

gscl_result gscl_measure_decoding(gscl_context *context, const uint8_t *bytes, size_t size, double *largest_error) {
    (void)bytes, (void)size, (void)largest_error;
    return refuse(context, "measuring accuracy");
}
