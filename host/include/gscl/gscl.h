/* gscl: an image codec that stores a picture as a set of 2D Gaussians ("splats").
 *
 * Conventions, stated once:
 *  - Functions that can fail return gscl_result; GSCL_OK is 0.  Out-parameters are written only on
 *    success, unless said otherwise.
 *  - What the library allocates for the caller is released with gscl_free (or the named function);
 *    every release function accepts NULL.
 *  - A context is used by one thread at a time; different contexts are independent.  Functions
 *    that take no context may be called from any thread.
 *  - The library never prints, exits, reads the environment or keeps global state (the OpenCL
 *    implementation underneath may do as it likes).
 *  - Images are row by row from the top left; x to the right, y down; pixel (i, j) has its centre at
 *    (i + 0.5, j + 0.5).  Samples are as stored in ordinary image files (gamma-encoded); grey and
 *    RGB values of floating-point images are in 0..1 and clamped to it. */
#ifndef GSCL_GSCL_H
#define GSCL_GSCL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/version.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define GSCL_API __attribute__((visibility("default")))
#define GSCL_CHECKED __attribute__((warn_unused_result))
#else
#define GSCL_API
#define GSCL_CHECKED
#endif

#define GSCL_MAX_DIMENSION 16384 /* pixels, of an encoded or decoded picture */
#define GSCL_MAX_SPLATS 1048576

/* Results.  Values are fixed for ever. */
typedef enum gscl_result {
    GSCL_OK = 0,
    GSCL_ERROR_INVALID_ARGUMENT = 1,    /* a NULL pointer or a value out of range */
    GSCL_ERROR_OUT_OF_MEMORY = 2,       /* on the host */
    GSCL_ERROR_CANCELLED = 3,           /* the progress callback said so */
    GSCL_ERROR_NO_PLATFORM = 10,        /* no OpenCL platform or no device at all */
    GSCL_ERROR_UNKNOWN_DEVICE = 11,     /* the device asked for does not exist */
    GSCL_ERROR_AMBIGUOUS_DEVICE = 12,   /* several devices match; the message lists them */
    GSCL_ERROR_DEVICE_MEMORY = 13,      /* the device has too little memory for this picture */
    GSCL_ERROR_DEVICE_FAILED = 14,      /* an OpenCL call failed */
    GSCL_ERROR_KERNEL_BUILD = 15,       /* the device's compiler refused a kernel */
    GSCL_ERROR_NOT_GSCL = 20,           /* not a gscl file */
    GSCL_ERROR_NEWER_VERSION = 21,      /* written in a newer format version */
    GSCL_ERROR_TRUNCATED = 22,          /* the file ends too early */
    GSCL_ERROR_DAMAGED = 23,            /* the checksum does not match */
    GSCL_ERROR_CORRUPT = 24,            /* a value outside the format's limits */
    GSCL_ERROR_IMAGE_SIZE = 30,         /* an image of zero size or beyond GSCL_MAX_DIMENSION */
    GSCL_ERROR_IMAGE_NOT_FINITE = 31,   /* NaN or infinite samples */
    GSCL_ERROR_BUDGET_TOO_SMALL = 40,   /* the message names the smallest possible size */
    GSCL_ERROR_TARGET_UNREACHABLE = 41, /* the quality asked for cannot be reached */
    GSCL_ERROR_CONFLICT = 42            /* settings that exclude each other */
} gscl_result;

/* One line of English for a result; never NULL. */
GSCL_API const char *gscl_result_text(gscl_result result);
/* GSCL_VERSION of the library that is running. */
GSCL_API const char *gscl_version(void);
/* Releases memory that the library returned. */
GSCL_API void gscl_free(void *memory);

/* ---- Devices and contexts ---------------------------------------------------------------- */

/* How kernels map pixels to work-items.  AUTO takes CPU for CPU devices and GPU for all others. */
typedef enum gscl_mapping { GSCL_MAPPING_AUTO = 0, GSCL_MAPPING_CPU = 1, GSCL_MAPPING_GPU = 2 } gscl_mapping;

typedef struct gscl_device_info {
    char id[16]; /* "P.D": platform and device number, what device selectors take */
    char platform_name[128];
    char device_name[128];
    char device_version[128];
    bool is_gpu;
    bool is_default;
    char why_default[96]; /* one phrase; empty when not the default */
    uint32_t compute_units;
    uint64_t memory_bytes;
    uint64_t max_allocation_bytes;
} gscl_device_info;

/* Lists all OpenCL devices; *devices is released with gscl_free. */
GSCL_API GSCL_CHECKED gscl_result gscl_list_devices(gscl_device_info **devices, size_t *count);

typedef enum gscl_log_level {
    GSCL_LOG_ERROR = 0,
    GSCL_LOG_WARNING = 1,
    GSCL_LOG_INFO = 2,
    GSCL_LOG_DEBUG = 3
} gscl_log_level;
typedef void (*gscl_log_callback)(void *opaque, gscl_log_level level, const char *message);

typedef struct gscl_context_settings {
    const char *device;    /* "P.D" or part of a device or platform name; NULL: the default device
                                (first GPU, else first accelerator, else first CPU) */
    gscl_mapping mapping;  /* default AUTO */
    gscl_log_callback log; /* default NULL: silent */
    void *log_opaque;
    bool timing; /* default false; true: gscl_context_timings tells where time goes, at the price of a little of it */
} gscl_context_settings;

typedef struct gscl_context gscl_context;

GSCL_API void gscl_context_settings_default(gscl_context_settings *settings);
/* Opens a device.  `settings` may be NULL (defaults).  On failure *context is still set when memory
 * allows, so that gscl_context_message can be read; free it in either case. */
GSCL_API GSCL_CHECKED gscl_result gscl_context_create(gscl_context **context, const gscl_context_settings *settings);
/* Frees the context and sets *context to NULL. */
GSCL_API void gscl_context_free(gscl_context **context);
/* The detailed text of the context's last error ("" if none); valid until its next call. */
GSCL_API const char *gscl_context_message(const gscl_context *context);
/* The device of this context. */
GSCL_API void gscl_context_device(const gscl_context *context, gscl_device_info *device);

/* Time that a context spent on one thing since it was made or its timings were reset. */
typedef struct gscl_timing {
    const char *name;      /* of a stage, "pyramid", or of a kernel, "fit_tiles" */
    bool is_kernel;        /* kernels run within stages: do not add up the two kinds */
    uint64_t count;        /* stages begun, kernels launched */
    double seconds;        /* stages: wall clock, the device's work included; kernels: the device's clock */
    double kernel_seconds; /* of a stage: what its kernels took */
} gscl_timing;
/* Stages and kernels in the order in which they first came; returns their number, 0 for a context without timing.
 * *timings is valid until the context's next call. */
GSCL_API size_t gscl_context_timings(const gscl_context *context, const gscl_timing **timings);
GSCL_API void gscl_context_reset_timings(gscl_context *context);

/* ---- Images ------------------------------------------------------------------------------ */

typedef enum gscl_sample {
    GSCL_SAMPLE_AUTO = 0,
    GSCL_SAMPLE_U8 = 1,
    GSCL_SAMPLE_U16 = 2,
    GSCL_SAMPLE_F32 = 3
} gscl_sample;

/* An image in memory, samples interleaved, native byte order. */
typedef struct gscl_image {
    uint32_t width, height; /* pixels */
    uint32_t channels;      /* 1 grey, 2 grey+alpha, 3 RGB, 4 RGBA */
    gscl_sample sample;     /* U8 (0..255), U16 (0..65535) or F32 (0..1) */
    size_t stride;          /* bytes from one row to the next; 0: rows are packed */
    bool premultiplied;     /* colours are multiplied by alpha; default false (as in PNG) */
    void *pixels;
} gscl_image;

/* ---- Effects ----------------------------------------------------------------------------- */

/* All that a splat may be beyond a grey disk.  Each has a flag in the file's header; one that is off has no bits in the
 * file and no instructions in the kernels. */
typedef enum gscl_effect {
    GSCL_EFFECT_CHROMA = 1u << 0,        /* colour; else grey */
    GSCL_EFFECT_ALPHA_CHANNEL = 1u << 1, /* else opaque (what is transparent becomes black) */
    GSCL_EFFECT_OPACITY = 1u << 2,       /* splats that count for less than others */
    GSCL_EFFECT_ROTATION = 1u << 3,      /* of ellipses; only with anisotropy */
    GSCL_EFFECT_ANISOTROPY = 1u << 4,    /* ellipses; else circles */
    GSCL_EFFECT_CODEBOOKS = 1u << 5,     /* the paper profile */
    GSCL_EFFECT_TEXTURE = 1u << 6        /* waves on some splats' colours */
} gscl_effect;
/* "chroma", "alpha-channel", ...; NULL when `effect` is not one effect. */
GSCL_API const char *gscl_effect_name(gscl_effect effect);

#define GSCL_MAX_EFFECTS 7

/* Who decided on an effect. */
typedef enum gscl_effect_reason {
    GSCL_EFFECT_ASKED = 0,   /* the settings */
    GSCL_EFFECT_CONTENT = 1, /* the image has, or lacks, what it is for */
    GSCL_EFFECT_PROFILE = 2, /* profile and blend */
    GSCL_EFFECT_TRIAL = 3,   /* trials: quick fits of this image */
    GSCL_EFFECT_PASSES = 4   /* the rate-distortion passes, splat by splat */
} gscl_effect_reason;
/* "asked", "content", "profile", "trial", "passes"; NULL for anything else. */
GSCL_API const char *gscl_effect_reason_name(gscl_effect_reason reason);

typedef struct gscl_effect_decision {
    gscl_effect effect;
    bool on;
    gscl_effect_reason reason;
    double gain_db; /* TRIAL: PSNR with it less PSNR without, of quick fits for the same budget; else NaN */
} gscl_effect_decision;

/* ---- Encoding ---------------------------------------------------------------------------- */

typedef enum gscl_profile {
    GSCL_PROFILE_DEFAULT = 0, /* scalar codes in the splat's own frame */
    GSCL_PROFILE_PAPER = 1    /* Zhang et al., "2D Gaussian Splatting for Image Compression" */
} gscl_profile;

typedef enum gscl_blend {
    GSCL_BLEND_AUTO = 0,       /* normalized in the default profile, alpha in the paper's */
    GSCL_BLEND_NORMALIZED = 1, /* weighted mean of splat colours */
    GSCL_BLEND_ALPHA = 2,      /* ordered alpha blending (paper eq. 4) */
    GSCL_BLEND_SUM = 3         /* background plus signed splats */
} gscl_blend;

/* Loss of the fit; AUTO is L2 in the default profile and L1+SSIM in the paper's. */
typedef enum gscl_loss { GSCL_LOSS_AUTO = 0, GSCL_LOSS_L1 = 1, GSCL_LOSS_L1_SSIM = 2, GSCL_LOSS_L2 = 3 } gscl_loss;

/* What the encoder spends bits on, where it has the choice. */
typedef enum gscl_tune {
    GSCL_TUNE_PSNR = 0, /* squared error, the same everywhere */
    GSCL_TUNE_SSIM = 1  /* MS-SSIM: errors count more where the image is smooth.  Default profile, loss L2 */
} gscl_tune;

/* What the encoder aims at. */
typedef enum gscl_target {
    GSCL_TARGET_AUTO = 0,  /* 0.125 bits per pixel, or 256 bytes if that is more */
    GSCL_TARGET_BPP = 1,   /* bits per pixel of the whole file, never exceeded */
    GSCL_TARGET_BYTES = 2, /* size of the whole file, never exceeded */
    GSCL_TARGET_PSNR = 3,  /* dB; met within +0.3 dB */
    GSCL_TARGET_SPLATS = 4 /* number of splats */
} gscl_target;

typedef struct gscl_progress {
    double fraction; /* 0..1 of the expected work */
    double psnr;     /* dB of the current fit; 0 while unknown */
    uint32_t splats;
    double elapsed_s, left_s; /* seconds; left_s is an estimate */
} gscl_progress;
/* Return true to go on, false to cancel (the encode returns GSCL_ERROR_CANCELLED). */
typedef bool (*gscl_progress_callback)(void *opaque, const gscl_progress *progress);

#define GSCL_MAX_EFFORT 9
#define GSCL_DEFAULT_EFFORT 5

typedef struct gscl_encode_settings {
    gscl_profile profile;   /* default DEFAULT */
    gscl_blend blend;       /* default AUTO */
    gscl_loss loss;         /* default AUTO */
    gscl_tune tune;         /* default PSNR */
    gscl_target target;     /* default AUTO */
    double target_value;    /* bpp, bytes, dB or count according to `target`; not used by AUTO */
    int effort;             /* 0 (fastest) .. 9 (best); default 5 */
    uint32_t codebook_size; /* paper profile: code words in each codebook, 2..1024; 0 (default): chosen by rate */
    uint32_t effects_on;    /* gscl_effect bits: these are used, */
    uint32_t effects_off;   /* these are not; the encoder decides on the others.  Default 0 */
    uint64_t seed;          /* default 1; same seed, settings, image and device: same bytes */
    double step_factor;     /* default profile: 0.25..4 times the quantiser's usual steps, as far as the format has such
                               steps; 0 (default): 1 */
    bool trace;             /* default false; true: the report has the convergence trace.  Same bytes, more time */
    gscl_progress_callback progress; /* default NULL */
    void *progress_opaque;
} gscl_encode_settings;

/* One stage of an encode. */
typedef struct gscl_stage_time {
    const char *name; /* static, as in gscl_timing */
    uint32_t count;   /* how often it was begun */
    double seconds;   /* wall clock, the device's work included */
} gscl_stage_time;

/* How far the fit had come at one moment: about two dozen while splats move, then one after each pass that chooses their
 * codes. */
typedef struct gscl_trace_point {
    const char *stage; /* under way: the name of one of the report's stages */
    uint32_t steps;    /* of gradient descent done, which passes do not count as */
    uint32_t splats;
    double seconds; /* since the encode began */
    double psnr;    /* dB of the picture drawn at full size, not rounded, against the image */
} gscl_trace_point;

#define GSCL_MAX_STAGES 32
#define GSCL_MAX_TRACE_POINTS 96

/* What an encode did; optional.  It holds no memory of the library's.  Times are on the wall clock, without the time that
 * the convergence trace took. */
typedef struct gscl_encode_report {
    uint32_t splats;
    uint64_t bytes;
    double psnr;      /* dB of the decoded file against the image (as gscl_compare) */
    double seconds;   /* all of it */
    uint32_t trials;  /* complete fits that the target took */
    gscl_blend blend; /* that was used */
    size_t effect_count;
    gscl_effect_decision effects[GSCL_MAX_EFFECTS]; /* what was decided on each effect that could have been used */
    uint32_t stage_count; /* stages in the order in which they first came; their seconds add up to all but a rest */
    gscl_stage_time stages[GSCL_MAX_STAGES];
    uint32_t trace_count; /* points of the last fit; 0 unless the settings ask for the trace */
    gscl_trace_point trace[GSCL_MAX_TRACE_POINTS];
} gscl_encode_report;

GSCL_API void gscl_encode_settings_default(gscl_encode_settings *settings);
/* Encodes `image` into a new buffer *bytes of *size bytes (release with gscl_free).
 * `settings` and `report` may be NULL. */
GSCL_API GSCL_CHECKED gscl_result gscl_encode(gscl_context *context, const gscl_image *image,
                                              const gscl_encode_settings *settings, uint8_t **bytes, size_t *size,
                                              gscl_encode_report *report);

/* ---- Decoding ---------------------------------------------------------------------------- */

typedef struct gscl_decode_settings {
    uint32_t width, height;           /* draw the whole picture at this size; 0: the size it was encoded at */
    uint32_t crop_x, crop_y;          /* rectangle of the drawn picture to return, in its pixels */
    uint32_t crop_width, crop_height; /* 0: all */
    gscl_sample sample;               /* default AUTO: U8 or U16, as the source was */
    bool premultiplied;               /* default false */
} gscl_decode_settings;

GSCL_API void gscl_decode_settings_default(gscl_decode_settings *settings);
/* Decodes into *image.  All fields of *image are set.  When image->pixels is NULL on entry the
 * library allocates packed rows (release image->pixels with gscl_free); otherwise pixels are written
 * to the caller's memory with the caller's stride, and width, height, channels and sample must already
 * be what the decode gives (see gscl_probe).  The context keeps its buffers on the device for the next decode. */
GSCL_API GSCL_CHECKED gscl_result gscl_decode(gscl_context *context, const uint8_t *bytes, size_t size,
                                              const gscl_decode_settings *settings, gscl_image *image);

/* ---- Looking into files (no context, no OpenCL) -------------------------------------------- */

typedef struct gscl_stream_bits {
    const char *name; /* "header", "position", ... static */
    double bits;
} gscl_stream_bits;
#define GSCL_MAX_STREAMS 16

typedef struct gscl_info {
    uint32_t format_version;
    uint32_t width, height;
    uint32_t channels;    /* of the decoded image, 1..4 */
    gscl_sample sample;   /* U8 or U16, of the source */
    gscl_profile profile; /* which coding: PAPER means codebooks */
    gscl_blend blend;
    uint32_t splats;
    uint32_t effects;                   /* gscl_effect bits that are on */
    uint32_t shape_words, colour_words; /* codebook sizes, else 0 */
    uint64_t bytes;
    size_t stream_count; /* streams with at least a bit; their bits add up to 8 * bytes */
    gscl_stream_bits streams[GSCL_MAX_STREAMS];
} gscl_info;

/* Header facts only; reads a few bytes, does not check the checksum.  stream_count is 0. */
GSCL_API GSCL_CHECKED gscl_result gscl_probe(const uint8_t *bytes, size_t size, gscl_info *info);
/* Reads the whole file: checks it and counts each stream's bits. */
GSCL_API GSCL_CHECKED gscl_result gscl_inspect(const uint8_t *bytes, size_t size, gscl_info *info);

/* What an effect is worth to a file. */
typedef struct gscl_effect_use {
    gscl_effect effect;
    double bits;    /* that the same splats take less without it; NaN where that cannot be told (paper profile) */
    double gain_db; /* PSNR that the same splats lose without it; NaN without an image, or likewise */
} gscl_effect_use;
/* The effects that are on in a file, at most GSCL_MAX_EFFECTS, each written (and, with an image, drawn) again without:
 * what the encoder would have made of the splats without it is not looked for.  `image`: the picture that was encoded,
 * in the kind of its decode, or NULL; with it a context is needed, else `context` may be NULL. */
GSCL_API GSCL_CHECKED gscl_result gscl_inspect_effects(gscl_context *context, const uint8_t *bytes, size_t size,
                                                       const gscl_image *image, gscl_effect_use *uses, size_t *count);

/* One splat as it is drawn. */
typedef struct gscl_splat {
    float x, y;           /* centre, pixels of the encoded size */
    float sigma1, sigma2; /* axes (standard deviations), pixels */
    float theta;          /* direction of the sigma1 axis, radians, 0..pi from +x towards +y */
    float opacity;        /* 0..1 */
    float colour[4];      /* R G B (equal when grey) premultiplied, and alpha */
} gscl_splat;
/* All splats in drawing order; *splats is released with gscl_free. */
GSCL_API GSCL_CHECKED gscl_result gscl_read_splats(const uint8_t *bytes, size_t size, gscl_splat **splats,
                                                   size_t *count);

/* ---- Quality ------------------------------------------------------------------------------ */

typedef struct gscl_comparison {
    double mse;            /* of samples in 0..255, all channels together (colours premultiplied if there is alpha) */
    double psnr;           /* dB, 10 log10(255^2 / mse); infinity when equal */
    double ssim;           /* mean over channels, 11x11 Gaussian window of sigma 1.5, valid area; NaN below 11 pixels */
    double ms_ssim;        /* five scales (Wang et al. 2003); NaN when the smallest scale is below 11 pixels */
    double max_difference; /* 0..255 */
} gscl_comparison;
/* Compares two images of the same size and kind (sample types may differ). */
GSCL_API GSCL_CHECKED gscl_result gscl_compare(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison);

/* ---- Speed -------------------------------------------------------------------------------- */

typedef struct gscl_benchmark_settings {
    uint32_t width, height; /* of the picture, pixels; default 768x512 */
    uint32_t splats;        /* default 2500: made up, of the sizes and shapes that fits leave */
    uint32_t repetitions;   /* 1..1000, default 20; a few more warm up */
} gscl_benchmark_settings;

/* Seconds that one thing takes. */
typedef struct gscl_measurement {
    const char *name; /* of a kernel, or "fit step": all of its kernels, on the wall clock */
    const char *unit; /* of `work`: "flop", "byte", or "evaluation" of a splat at a pixel */
    gscl_blend blend; /* AUTO where it does not apply */
    uint32_t splats;  /* 0 where it does not apply */
    double work;      /* of one run */
    double needed;    /* evaluations inside the splats' outlines, which no renderer could do without */
    double flop; /* of one run, nominal: 28 an evaluation forward, 100 in a whole step; 0 where it has no meaning */
    double median_s, fastest_s, slowest_s;
} gscl_measurement;
typedef void (*gscl_measurement_callback)(void *opaque, const gscl_measurement *measurement);

GSCL_API void gscl_benchmark_settings_default(gscl_benchmark_settings *settings);
/* Measures what the device can do: "multiply_add" and "copy".  Like the next, it needs a context with timing, takes
 * NULL for the default settings, and resets the context's timings. */
GSCL_API GSCL_CHECKED gscl_result gscl_benchmark_device(gscl_context *context, const gscl_benchmark_settings *settings,
                                                        gscl_measurement_callback callback, void *opaque);
/* Measures the kernels of drawing and fitting, for each blend. */
GSCL_API GSCL_CHECKED gscl_result gscl_benchmark_kernels(gscl_context *context, const gscl_benchmark_settings *settings,
                                                         gscl_measurement_callback callback, void *opaque);

/* ---- What exactness costs ------------------------------------------------------------------- */

typedef struct gscl_accuracy_settings {
    uint32_t repetitions; /* of what is timed: 1..1000, default 20; a few more warm up */
    uint32_t splats;      /* whose derivatives are taken: 1..1000, default 48 */
} gscl_accuracy_settings;

/* One way of drawing a file's splats: how far it is off, and how long it takes.  `choice` says what is varied:
 *   "support"      where Gaussians are cut off, `value` in sigmas; errors are those against Gaussians without end
 *   "exponential"  "polynomial", "exp2" or "native_exp2"
 *   "precision"    "float32" or "float64" (only where the device has it)
 *   "early stop"   the transmittance, `value`, below which nothing behind is drawn; 0: all is.  Blend alpha only
 *   "quantiser"    `value` times the steps that the encoder takes, as far as the format has such steps; errors are those
 *                  against splats that are not quantised.  Default profile, blends normalized and sum only
 * Other errors are those against the format's definition in double precision. */
typedef struct gscl_accuracy {
    const char *choice;  /* static */
    const char *variant; /* in a word, "3.74 sigma"; valid until the callback returns */
    double value;
    bool is_default;
    gscl_blend blend;                 /* of the file */
    double largest_error, mean_error; /* of samples clamped to 0..1, in units of 1/255 */
    double ns_per_pixel;   /* of the device, all kernels of a drawing: median; 0 where it makes no difference */
    double bits_per_splat; /* of the file, "quantiser" only, else 0 */
    double psnr;           /* dB of what is drawn against the image */
} gscl_accuracy;
typedef void (*gscl_accuracy_callback)(void *opaque, const gscl_accuracy *accuracy);

/* How far the derivatives of the fit's squared error are from central differences in double precision, over one kind of
 * parameter: "position", "scale", "angle", "opacity" or "colour". */
typedef struct gscl_gradient_accuracy {
    const char *kind;    /* static, */
    const char *variant; /* and so is this: of the exponential, as above */
    bool is_default;
    gscl_blend blend;
    uint32_t parameters;  /* compared */
    double rms_error;     /* root mean square of the errors over that of the derivatives */
    double largest_error; /* largest error over the largest derivative */
    double ns_per_pixel;  /* of the device, drawing and differentiating: median */
} gscl_gradient_accuracy;
typedef void (*gscl_gradient_callback)(void *opaque, const gscl_gradient_accuracy *accuracy);

GSCL_API void gscl_accuracy_settings_default(gscl_accuracy_settings *settings);
/* Draws a file with each choice.  `image` is what was encoded.  Like the next, it needs a context with timing, takes NULL
 * for the default settings, resets the context's timings, and calls back once for each result, in order. */
GSCL_API GSCL_CHECKED gscl_result gscl_measure_accuracy(gscl_context *context, const gscl_image *image,
                                                        const uint8_t *bytes, size_t size,
                                                        const gscl_accuracy_settings *settings,
                                                        gscl_accuracy_callback callback, void *opaque);
/* Differentiates the squared error of a file's splats in a part of the image: at most 128x128 pixels around the splat that
 * is nearest to its middle. */
GSCL_API GSCL_CHECKED gscl_result gscl_measure_gradients(gscl_context *context, const gscl_image *image,
                                                         const uint8_t *bytes, size_t size,
                                                         const gscl_accuracy_settings *settings,
                                                         gscl_gradient_callback callback, void *opaque);

#ifdef __cplusplus
}
#endif
#endif
