/* gscl: an image codec that stores an image as a set of 2D Gaussians ("splats").
 *
 * This header is all that a program needs to encode and decode; gscl/measure.h compares images and measures speed and
 * accuracy.  A complete program that encodes a black image and decodes it again:
 *
 *     #include <gscl/gscl.h>
 *     static uint8_t pixels[48][64][3], *bytes;
 *     int main(void) {
 *         gscl_context *context;
 *         size_t size;
 *         gscl_image image = {64, 48, 3, GSCL_SAMPLE_U8, 0, false, pixels, GSCL_LAYOUT_RGB}, decoded = {0};
 *         gscl_result result = gscl_context_create(&context, NULL);
 *         if (result == GSCL_OK) result = gscl_encode(context, &image, NULL, &bytes, &size, NULL);
 *         if (result == GSCL_OK) result = gscl_decode(context, bytes, size, NULL, &decoded);
 *         gscl_free(decoded.pixels), gscl_free(bytes), gscl_context_free(&context);
 *         return result;
 *     }
 *
 * Conventions
 *  - Functions that can fail return gscl_result; GSCL_OK is 0.  Output parameters are written on success only, unless a
 *    function says otherwise.
 *  - The caller releases memory that the library allocated with gscl_free or with the function that is named.  Every
 *    release function accepts NULL.
 *  - A context is used by one thread at a time; different contexts are independent of each other.  Functions without a
 *    context may be called from any thread.  A debug build of the library ends the program with a message when two calls
 *    use one context at the same time.  gscl_encode may build kernels in a thread of its own, which receives no signals and
 *    has ended when the call returns.
 *  - Otherwise the library never prints, exits, reads the environment or keeps global state.  The OpenCL implementation that it
 *    uses may do all of these.
 *  - Images are stored row by row from the top left, or from the bottom left where gscl_image.stride is negative; x
 *    points to the right and y down.  Pixel (i, j) has its centre at (i + 0.5, j + 0.5).  Samples are gamma-encoded as
 *    in ordinary image files.  Floating-point samples are clamped to 0..1.
 *
 * How the interface grows.  A program that was compiled with an older header works with a newer library of the same
 * soname, because
 *  - a struct that the caller allocates and that may gain fields begins with `struct_size`: the size of the struct as the
 *    caller's header declares it.  The library neither reads nor writes beyond that size and takes the default for
 *    settings that lie beyond it.  The functions *_settings_default set struct_size; for a struct that the library fills
 *    in, the caller sets it before the call (`gscl_info info = {.struct_size = sizeof info};`).  Functions return
 *    GSCL_ERROR_STRUCT_SIZE for a size that is zero or that no version up to the library's has;
 *  - structs that the library allocates and passes by pointer (gscl_device_info, gscl_progress, gscl_timing,
 *    gscl_measurement and the like) may gain fields at their end.  They are passed one by one or as lists that are
 *    linked by `next`, never as arrays, so that their size does not matter to the caller;
 *  - gscl_image and the rows of arrays (gscl_splat, gscl_stream_bits, gscl_stage_time, gscl_trace_point,
 *    gscl_effect_decision, gscl_effect_use) never change, nor do the lengths of arrays in structs.  A new kind of image
 *    or a new figure gets a new sample type, array or function;
 *  - enumerations may gain values.  A program must expect values that it does not know in what it receives.
 * A program compiled with a newer header than the library's is not supported; gscl_version_number tells them apart. */
#ifndef GSCL_GSCL_H
#define GSCL_GSCL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/version.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32) && defined(GSCL_BUILD) /* the library itself is being compiled */
#define GSCL_API __declspec(dllexport)
#elif defined(__GNUC__) && !defined(_WIN32)
#define GSCL_API __attribute__((visibility("default")))
#else
#define GSCL_API
#endif
#if defined(__GNUC__)
#define GSCL_CHECKED __attribute__((warn_unused_result))
#else
#define GSCL_CHECKED
#endif

#define GSCL_MAX_DIMENSION 16384 /* largest width and height of an encoded or decoded image, pixels */
#define GSCL_MAX_SPLATS 1048576  /* of one file */

/* ---- Results, version, memory -------------------------------------------------------------- */

/* The values never change. */
typedef enum gscl_result {
    GSCL_OK = 0,
    GSCL_ERROR_INVALID_ARGUMENT = 1,  /* a NULL pointer or a value out of range */
    GSCL_ERROR_OUT_OF_MEMORY = 2,     /* on the host */
    GSCL_ERROR_CANCELLED = 3,         /* by a progress callback */
    GSCL_ERROR_STRUCT_SIZE = 4,       /* struct_size was not set, or is not one that this library knows */
    GSCL_ERROR_NO_PLATFORM = 10,      /* no OpenCL platform or no device at all */
    GSCL_ERROR_UNKNOWN_DEVICE = 11,   /* no device matches the selector */
    GSCL_ERROR_AMBIGUOUS_DEVICE = 12, /* several devices match the selector; the message lists them */
    GSCL_ERROR_DEVICE_MEMORY = 13,    /* the device has too little memory for this image */
    GSCL_ERROR_DEVICE_FAILED = 14,    /* an OpenCL call failed */
    GSCL_ERROR_KERNEL_BUILD = 15,     /* the device's compiler rejected a kernel */
    GSCL_ERROR_NO_ENCODER = 16,       /* this needs kernels, and the context or the library only decodes */
    GSCL_ERROR_GROUP_SIZE = 17,    /* the device has too small work-groups for a kernel; the message has both sizes */
    GSCL_ERROR_NOT_GSCL = 20,      /* not a gscl file */
    GSCL_ERROR_NEWER_VERSION = 21, /* written in a newer format version */
    GSCL_ERROR_TRUNCATED = 22,     /* the file ends too early */
    GSCL_ERROR_DAMAGED = 23,       /* the check at the end does not match */
    GSCL_ERROR_CORRUPT = 24,       /* the check matches, but the file breaks a rule of the format */
    GSCL_ERROR_LIMIT = 25,         /* decoding needs more than max_pixels or max_work; the message has the figures */
    GSCL_ERROR_UNKNOWN_BLOCK = 26, /* a block of a type unknown here that a reader must understand */
    GSCL_ERROR_OTHER_PICTURE = 27, /* a packet of another picture than those before it */
    GSCL_ERROR_IMAGE_SIZE = 30,    /* an image without pixels or larger than GSCL_MAX_DIMENSION */
    GSCL_ERROR_IMAGE_NOT_FINITE = 31,   /* NaN or infinite samples */
    GSCL_ERROR_BUDGET_TOO_SMALL = 40,   /* the message names the smallest possible size */
    GSCL_ERROR_TARGET_UNREACHABLE = 41, /* no file reaches the quality of the settings, or it cannot be measured */
    GSCL_ERROR_CONFLICT = 42,           /* settings that exclude each other */
    GSCL_ERROR_FIELD = 43               /* a field of splats that the format does not have */
} gscl_result;

/* Returns one line of English for a result, never NULL.  The text is static. */
GSCL_API const char *gscl_result_text(gscl_result result);

/* Returns GSCL_VERSION of the library that is running.  The text is static. */
GSCL_API const char *gscl_version(void);
/* Returns GSCL_VERSION_NUMBER of the library that is running. */
GSCL_API uint32_t gscl_version_number(void);

/* Releases memory that the library allocated for the caller. */
GSCL_API void gscl_free(void *memory);

/* ---- Devices and contexts ------------------------------------------------------------------ */

/* How kernels map pixels to work-items.  AUTO is CPU for CPU devices and GPU for all others, but for
 * CPU devices whose implementation treats them like GPUs. */
typedef enum gscl_mapping { GSCL_MAPPING_AUTO = 0, GSCL_MAPPING_CPU = 1, GSCL_MAPPING_GPU = 2 } gscl_mapping;

/* An OpenCL device.  All texts end with a zero byte. */
typedef struct gscl_device_info {
    const struct gscl_device_info *next; /* in the list of gscl_list_devices; NULL for the last device */
    char id[16];                         /* "P.D": numbers of platform and device, as device selectors take it */
    char platform_name[128];             /* of the OpenCL implementation; "gscl" for GSCL_HOST_DEVICE */
    char device_name[128];               /* as its driver names it */
    char device_version[128];            /* of OpenCL and of the driver */
    bool is_gpu;                         /* as OpenCL says */
    bool is_default;                     /* whether a context without a device opens it */
    char why_default[96];                /* one phrase; empty unless is_default */
    uint32_t compute_units;              /* of the device, as OpenCL counts them */
    uint64_t memory_bytes;               /* global memory */
    uint64_t max_allocation_bytes;       /* largest single buffer */
} gscl_device_info;

/* The id of a device that every machine has: the processor itself.  It needs no OpenCL and starts at once.  A library that was
 * built with kernels for this processor (meson option `native`) encodes, decodes and measures on it, with threads; all but the
 * measurements of other precision (gscl_measure_accuracy, gscl_measure_gradients), which fail with GSCL_ERROR_KERNEL_BUILD.
 * Its kernels have the CPU mapping only.  In other libraries it decodes on one core, and all else fails with
 * GSCL_ERROR_NO_ENCODER; gscl_list_devices does not list it then.  Pictures are those of OpenCL devices within the tolerance
 * of the format. */
#define GSCL_HOST_DEVICE "host"

/* Lists all devices that encode: those of OpenCL in the order of their ids, then the processor.  *devices is the first one;
 * the caller releases the whole list with gscl_free(*devices).  Errors: GSCL_ERROR_NO_PLATFORM when there is no device, or no OpenCL loader. */
GSCL_API GSCL_CHECKED gscl_result gscl_list_devices(gscl_device_info **devices);

/* How important a line of the log is. */
typedef enum gscl_log_level {
    GSCL_LOG_ERROR = 0,
    GSCL_LOG_WARNING = 1,
    GSCL_LOG_INFO = 2,
    GSCL_LOG_DEBUG = 3
} gscl_log_level;
/* Receives one line of text without a newline, valid during the call. */
typedef void (*gscl_log_callback)(void *opaque, gscl_log_level level, const char *message);

/* Called by the thread of a call when it begins (true) and ends (false) to wait for kernels that are being built.  Kernels
 * that are found built are not reported.  It must not call the library with this context. */
typedef void (*gscl_build_callback)(void *opaque, bool begins);

#define GSCL_MAX_THREADS 1024 /* of the setting `threads` */

/* How a context is opened: a device and what it reports. */
typedef struct gscl_context_settings {
    size_t struct_size; /* set by gscl_context_settings_default */
    const char *device; /* "P.D", or a part of a device or platform name, or GSCL_HOST_DEVICE; default NULL: a GPU, else
                              the first accelerator, else GSCL_HOST_DEVICE where it encodes, else the first CPU of OpenCL.
                              Of several GPUs one with memory of its own rather than the processor's, then the one with
                              the most memory, then the most compute units, then the first in the list.  With
                              GSCL_MAPPING_GPU: of OpenCL devices only */
    gscl_mapping mapping;  /* default AUTO */
    bool timing;           /* whether gscl_context_timings (gscl/measure.h) has data; default false.  It costs time */
    gscl_log_callback log; /* default NULL: no log */
    void *log_opaque;      /* first argument of `log` */
    const char *cache_folder;  /* where kernels that were built are kept for later contexts, made when it is missing;
                                 default NULL: nowhere.  Any number of processes may use a folder at a time; only those
                                 who may run programs as this user should be able to write to it.  It takes at most
                                 64 MiB.  OpenCL implementations that keep kernels themselves (PoCL, NVIDIA, all on
                                 Windows) are left to it.  A folder that cannot be read or written costs time and is no error */
    gscl_build_callback build; /* default NULL */
    void *build_opaque;        /* first argument of `build` */
    int threads; /* of GSCL_HOST_DEVICE, the caller's included: 1 to GSCL_MAX_THREADS; default 0: as many as the process may
                     run (affinity, and the quotas of control groups).  Files and pictures do not depend on it.  Several
                     contexts that work at the same time share the processor: each takes fewer threads */
} gscl_context_settings;

/* Sets a struct of struct_size bytes to the defaults.  Programs in C and C++ call gscl_context_settings_default. */
GSCL_API void gscl_context_settings_init(gscl_context_settings *settings, size_t struct_size);
static inline void gscl_context_settings_default(gscl_context_settings *settings) {
    gscl_context_settings_init(settings, sizeof *settings);
}

/* A device that is open, with its compiled kernels, its buffers and the text of the last error.  Contexts of a process on the
 * same OpenCL device share its compiled kernels and work at the same time; each belongs to one thread at a time. */
typedef struct gscl_context gscl_context;

/* Opens a device.  `settings` may be NULL for the defaults.  When this fails, *context is a context for
 * gscl_context_message alone, or NULL if memory does not allow one; the caller frees it in either case.
 * Errors: GSCL_ERROR_NO_PLATFORM, _UNKNOWN_DEVICE, _AMBIGUOUS_DEVICE, _DEVICE_FAILED, _INVALID_ARGUMENT, and _GROUP_SIZE, with
 * which calls that run kernels fail, too: another mapping may have smaller groups. */
GSCL_API GSCL_CHECKED gscl_result gscl_context_create(gscl_context **context, const gscl_context_settings *settings);
/* Frees a context and sets *context to NULL. */
GSCL_API void gscl_context_free(gscl_context **context);
/* Returns the detailed text of the context's last error, "" if there was none.  Valid until the context's next call. */
GSCL_API const char *gscl_context_message(const gscl_context *context);
/* Returns the device of a context, valid as long as the context; NULL for NULL.  Its `next` is NULL. */
GSCL_API const gscl_device_info *gscl_context_device(const gscl_context *context);

/* ---- Images -------------------------------------------------------------------------------- */

/* The type of samples in memory. */
typedef enum gscl_sample {
    GSCL_SAMPLE_AUTO = 0, /* in decode settings only */
    GSCL_SAMPLE_U8 = 1,   /* uint8_t, 0..255 */
    GSCL_SAMPLE_U16 = 2,  /* uint16_t, 0..65535, native byte order */
    GSCL_SAMPLE_F32 = 3   /* float, 0..1 */
} gscl_sample;

/* The channels of a pixel in the order of their samples in memory. */
typedef enum gscl_layout {
    GSCL_LAYOUT_AUTO = 0, /* in images: the one of the next four that has `channels`; in decode settings: as stored */
    GSCL_LAYOUT_GREY = 1, /* 1 channel */
    GSCL_LAYOUT_GREY_ALPHA = 2, /* 2 channels */
    GSCL_LAYOUT_RGB = 3,        /* 3 channels */
    GSCL_LAYOUT_RGBA = 4,       /* 4 channels */
    GSCL_LAYOUT_BGR = 5,        /* 3 channels */
    GSCL_LAYOUT_BGRA = 6        /* 4 channels; of 8 bits, what Cairo, Qt, Direct3D and GDI call ARGB32 on little-endian
                                   processors */
} gscl_layout;

/* An image in memory: height rows of width pixels of `channels` interleaved samples.  This struct never changes. */
typedef struct gscl_image {
    uint32_t width, height; /* pixels, 1..GSCL_MAX_DIMENSION */
    uint32_t channels;      /* 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA */
    gscl_sample sample;     /* type of all samples */
    ptrdiff_t stride;   /* bytes from one row to the next below it, any number; 0: rows follow each other without a gap.
                         Negative where the bottom row comes first in memory */
    bool premultiplied; /* whether colours are multiplied by alpha; false in PNG files */
    void *pixels;       /* the top row, which with a negative stride is the last in memory; at any address, also for
                           samples of several bytes */
    gscl_layout layout; /* 0, GSCL_LAYOUT_AUTO, or a layout of `channels` channels */
} gscl_image;

/* ---- Blocks -------------------------------------------------------------------------------- */

/* Data about the picture, which a file may hold beside it.  The library neither interprets nor applies them. */
typedef enum gscl_block_type {
    GSCL_BLOCK_COLOUR_SPACE =
        0,               /* two bytes: the code points of the primaries and of the transfer function in ITU-T H.273
                                    (CICP).  Samples are always R, G, B or grey of the full range.  Without this block and
                                    an ICC profile they are sRGB */
    GSCL_BLOCK_ICC = 1,  /* an ICC profile */
    GSCL_BLOCK_EXIF = 2, /* the TIFF structure, without a leading "Exif\0\0" */
    GSCL_BLOCK_XMP = 3   /* an XMP packet */
} gscl_block_type;
#define GSCL_MAX_BLOCK_SIZE 2097151 /* bytes */

/* A list of blocks, with at most one of each type. */
typedef struct gscl_block {
    const struct gscl_block *next; /* NULL for the last one */
    gscl_block_type type;          /* which data these are */
    const void *data;              /* copied into the file */
    size_t size;                   /* bytes, 1..GSCL_MAX_BLOCK_SIZE; 2 for COLOUR_SPACE */
} gscl_block;

/* ---- Effects ------------------------------------------------------------------------------- */

/* Properties that splats may have beyond those of a grey disk.  Each has a flag in the file's header.  An effect that is
 * off takes no bits in the file and no instructions in the kernels. */
typedef enum gscl_effect {
    GSCL_EFFECT_CHROMA = 1u << 0,        /* colour; without it the image is grey */
    GSCL_EFFECT_ALPHA_CHANNEL = 1u << 1, /* without it the image is opaque: transparent pixels become black */
    GSCL_EFFECT_OPACITY = 1u << 2,       /* a weight for each splat */
    GSCL_EFFECT_ROTATION = 1u << 3,      /* of ellipses; needs ANISOTROPY */
    GSCL_EFFECT_ANISOTROPY = 1u << 4,    /* ellipses; without it all splats are circles */
    GSCL_EFFECT_CODEBOOKS = 1u << 5,     /* the coding of the paper profile */
    GSCL_EFFECT_TEXTURE = 1u << 6        /* a cosine wave on the colour of some splats */
} gscl_effect;
#define GSCL_EFFECT_COUNT 7 /* effects that this version supports */
#define GSCL_MAX_EFFECTS 16 /* rows of arrays with one row for each effect */

/* Returns "chroma", "alpha-channel", ...; NULL when `effect` is not exactly one effect.  The text is static. */
GSCL_API const char *gscl_effect_name(gscl_effect effect);

/* The basis of the decision on an effect. */
typedef enum gscl_effect_reason {
    GSCL_EFFECT_REQUESTED = 0, /* the settings effects_on and effects_off */
    GSCL_EFFECT_CONTENT = 1,   /* the content of the image */
    GSCL_EFFECT_PROFILE = 2,   /* profile and blend */
    GSCL_EFFECT_TRIAL = 3,     /* trials: short fits of this image with and without the effect */
    GSCL_EFFECT_PASSES = 4     /* the rate-distortion passes, splat by splat */
} gscl_effect_reason;
/* Returns "requested", "content", "profile", "trial" or "passes"; NULL for other values.  The text is static. */
GSCL_API const char *gscl_effect_reason_name(gscl_effect_reason reason);

/* This struct never changes. */
typedef struct gscl_effect_decision {
    gscl_effect effect;        /* exactly one */
    bool on;                   /* whether the file has it */
    gscl_effect_reason reason; /* of the decision */
    double gain_db; /* for TRIAL: PSNR with the effect less PSNR without it, of short fits at equal size; else NaN */
} gscl_effect_decision;

/* ---- Encoding ------------------------------------------------------------------------------ */

/* How splats are coded. */
typedef enum gscl_profile {
    GSCL_PROFILE_DEFAULT = 0, /* scalar codes in the splat's own frame */
    GSCL_PROFILE_PAPER = 1    /* codebooks, as in Zhang et al., "2D Gaussian Splatting for Image Compression" */
} gscl_profile;

/* How the colours of splats at a pixel are combined. */
typedef enum gscl_blend {
    GSCL_BLEND_AUTO = 0,       /* NORMALIZED in the default profile, ALPHA in the paper profile */
    GSCL_BLEND_NORMALIZED = 1, /* weighted mean of splat colours */
    GSCL_BLEND_ALPHA = 2,      /* ordered alpha blending (equation 4 of the paper) */
    GSCL_BLEND_SUM = 3         /* background plus signed splats */
} gscl_blend;

/* Loss of the fit.  AUTO is L2 in the default profile and L1_SSIM in the paper profile. */
typedef enum gscl_loss { GSCL_LOSS_AUTO = 0, GSCL_LOSS_L1 = 1, GSCL_LOSS_L1_SSIM = 2, GSCL_LOSS_L2 = 3 } gscl_loss;

/* The measure of quality that the encoder maximises. */
typedef enum gscl_tune {
    /* PSNR where that is the target, for pictures of less than 600 bytes (without the container) unless the target is
     * SSIMULACRA2 or QUALITY, for images with transparent parts or more than GSCL_MAX_VISUAL_PIXELS, in the paper profile, and with
     * another loss than L2; else VISUAL */
    GSCL_TUNE_AUTO = 0,
    GSCL_TUNE_PSNR = 1, /* squared error with equal weights */
    GSCL_TUNE_SSIM = 2, /* MS-SSIM: errors in smooth regions weigh more.  Default profile and loss L2 only */
    /* What people see, by SSIMULACRA 2 and squared error: more texture, PSNR lower by 0.1 to 0.8 dB; for opaque images.  Where
     * hardly anything is seen of the error, it is squared error alone.  Default profile and loss L2 only. */
    GSCL_TUNE_VISUAL = 3
} gscl_tune;
/* Largest image, in pixels, for which AUTO is VISUAL: up to it an encode takes less than 1 GiB, and 1.4 GiB at 25
 * megapixels, where PSNR takes 0.9. */
#define GSCL_MAX_VISUAL_PIXELS (16u << 20)

/* The target of an encode, with the unit and the range of target_value.  Targets in bytes that are smaller than the
 * smallest file of an image are GSCL_ERROR_BUDGET_TOO_SMALL; of larger ones than an image can use, the file stays
 * smaller. */
typedef enum gscl_target {
    GSCL_TARGET_AUTO = 0,  /* 0.125 bits per pixel, or 256 bytes if that is more, and the blocks on top; target_value
                              must be 0 */
    GSCL_TARGET_BPP = 1,   /* bits per pixel of the whole file, 0..GSCL_MAX_TARGET_BPP, never exceeded */
    GSCL_TARGET_BYTES = 2, /* bytes of the whole file, 0..GSCL_MAX_TARGET_BYTES, never exceeded */
    GSCL_TARGET_PSNR = 3,  /* dB, 0..GSCL_MAX_TARGET_PSNR, never below, exceeded by at most 0.3, or by what 2.5 % of the
                              bytes bring */
    GSCL_TARGET_SPLATS = 4, /* number of splats, 0..GSCL_MAX_SPLATS */
    /* SSIMULACRA 2.1 of the decoded file against the image, as gscl_compare (gscl/measure.h) computes it:
     * GSCL_MIN_SSIMULACRA2..100, never below the target, mostly exceeded by less than 1; by at most 2, or by what 5 % of
     * the bytes bring.
     * Samples are taken as sRGB and at their own depth; grey as RGB; with alpha the lower score of those in front of a
     * dark and a bright background counts.  Images with a side below 8 pixels have none: GSCL_ERROR_TARGET_UNREACHABLE.
     * Measuring takes 84 bytes of memory for each pixel of an RGB image */
    GSCL_TARGET_SSIMULACRA2 = 5,
    /* Quality as of JPEG, 0..100: a SSIMULACRA 2 of target_value from 30 on, and of 30 - 8/3 (30 - target_value) below, down to
     * -50.  Where it cannot be reached, the best file that was found is the result.  For images with a side below 8 pixels it is a
     * PSNR of 20 + target_value / 4 dB */
    GSCL_TARGET_QUALITY = 6,
    /* Bits per pixel, 0..GSCL_MAX_TARGET_BPP, or 256 bytes if that is more, and the blocks on top, as AUTO: images of any size have
     * such a file */
    GSCL_TARGET_RATE = 7
} gscl_target;
/* The SSIMULACRA 2 that a quality stands for. */
static inline double gscl_quality_score(double quality) {
    return quality < 30 ? quality - (30 - quality) * 5 / 3 : quality;
}
#define GSCL_MAX_TARGET_BPP 100000000    /* more than a picture of one pixel has with blocks of the largest size */
#define GSCL_MAX_TARGET_BYTES 4294967295 /* 2^32 - 1, more than any file has */
#define GSCL_MAX_TARGET_PSNR 200         /* dB, more than floating-point samples allow */
#define GSCL_MIN_SSIMULACRA2 (-100)      /* smallest target; such a picture is a blur */

/* How far an encode or a decode is. */
typedef struct gscl_progress {
    double fraction;    /* of the expected work, 0..1; never decreases */
    double psnr;        /* dB of the current fit; 0 while unknown, and in a decode */
    uint32_t splats;    /* of the current fit, or of the file that is decoded */
    double elapsed_s;   /* seconds since the encode or the decode began */
    double remaining_s; /* seconds until it ends, an estimate; INFINITY while nothing is done, and 0 only in the last
                           call, when nothing remains */
} gscl_progress;
/* Returns true to continue and false to cancel; a cancelled encode or decode returns GSCL_ERROR_CANCELLED. */
typedef bool (*gscl_progress_callback)(void *opaque, const gscl_progress *progress);

#define GSCL_MAX_EFFORT 9     /* the best and slowest */
#define GSCL_DEFAULT_EFFORT 5 /* of the settings' defaults */

/* What an encode writes, and how. */
typedef struct gscl_encode_settings {
    size_t struct_size;              /* set by gscl_encode_settings_default */
    gscl_profile profile;            /* default DEFAULT */
    gscl_blend blend;                /* default AUTO; the paper profile allows AUTO and ALPHA only */
    gscl_loss loss;                  /* default AUTO */
    gscl_tune tune;                  /* default AUTO */
    gscl_target target;              /* default AUTO */
    double target_value;             /* default 0; `target` says its unit and range */
    int effort;                      /* 0 (fastest) .. GSCL_MAX_EFFORT (best); default GSCL_DEFAULT_EFFORT */
    uint32_t codebook_size;          /* code words of each codebook, 2..1024, paper profile only; default 0: by rate */
    uint32_t effects_on;             /* bits of gscl_effect that are switched on; default 0 */
    uint32_t effects_off;            /* bits that are switched off; default 0.  The encoder decides on all others */
    uint64_t seed;                   /* default 1.  Equal seed, settings, image and device give equal bytes */
    gscl_progress_callback progress; /* default NULL */
    void *progress_opaque;           /* first argument of `progress` */
    double step_factor;              /* scale of the default quantiser steps, 0.25..4, default profile only; rounded to
                                        the nearest step that the format has; default 0: no scaling */
    bool trace; /* whether the report has the convergence trace; default false.  It takes time; the bytes stay equal */
    bool bare; /* whether to write the picture alone, without magic bytes, version, blocks and check, for those who keep
                   its size and know its type; default false.  A reader must be told (gscl_decode_settings.bare) */
    bool progressive; /* whether to write layers, each fitted to what those before it leave, so that the first part of
                         the file draws a better picture; the whole one is worse by 0.5 to 1 dB; default profile only;
                         default false */
    const gscl_block
        *blocks; /* copied into the file and counted by its targets in bytes; not with `bare`; default NULL */
    uint32_t
        packet_size; /* largest size of a packet, GSCL_MIN_PACKET_SIZE..GSCL_MAX_PACKET_SIZE bytes: writes packets (see
                              "Packets") instead of a file; default 0: a file.  Default profile only, with a target in
                              bytes or AUTO; not with `bare`, `progressive` or `blocks` */
    uint32_t
        packet_count; /* 1..GSCL_MAX_PACKETS packets, which together are the target; default 0: as many as the target,
                              which is of all packets, needs */
    uint32_t packet_identity; /* of the picture: 1..255, but not 199; default 0: a number that follows from the picture.
                                 A sender of many pictures counts through them, so that no two in a row have the same */
    double
        packet_loss; /* share of packets that are expected to be lost, 0..0.9: some packets become repair packets, from
                           which as many others are computed again as are lost, so that the expected quality is best;
                           default 0: none */
} gscl_encode_settings;

/* Sets a struct of struct_size bytes to the defaults.  Programs in C and C++ call gscl_encode_settings_default. */
GSCL_API void gscl_encode_settings_init(gscl_encode_settings *settings, size_t struct_size);
static inline void gscl_encode_settings_default(gscl_encode_settings *settings) {
    gscl_encode_settings_init(settings, sizeof *settings);
}

/* Targets with an effort, by names that say what a file is for.  Of photographs of 768x512 pixels an encode takes 1, 1, 2.5 and 9 to
 * 20 seconds of a processor. */
typedef enum gscl_preset {
    GSCL_PRESET_TINY = 0,    /* 250 bytes: a placeholder inside a page or a record of a database; effort 3 */
    GSCL_PRESET_PREVIEW = 1, /* 0.06 bits per pixel, or 256 bytes if that is more: a small file, soon there; effort 3 */
    GSCL_PRESET_SMALL = 2,   /* the defaults: 0.125 bits per pixel, or 256 bytes if that is more; effort 5 */
    GSCL_PRESET_GOOD = 3     /* quality 50, some 0.5 bits per pixel: a picture to look at; effort 5 */
} gscl_preset;

/* Returns "tiny", "preview", "small" or "good"; NULL for other values.  The text is static. */
GSCL_API const char *gscl_preset_name(gscl_preset preset);

/* Sets target, target_value and effort to those of a preset, and nothing else.  gscl_encode_settings_default comes before it.
 * Errors: GSCL_ERROR_INVALID_ARGUMENT for NULL and for an unknown preset, GSCL_ERROR_STRUCT_SIZE; settings then stay as they
 * are. */
GSCL_API GSCL_CHECKED gscl_result gscl_encode_settings_preset(gscl_encode_settings *settings, gscl_preset preset);

/* One stage of an encode.  This struct never changes. */
typedef struct gscl_stage_time {
    const char *name; /* as in gscl_timing (gscl/measure.h); static */
    uint32_t count;   /* number of times that the stage began */
    double seconds;   /* wall clock, with the work of the device */
} gscl_stage_time;

/* State of the fit at one moment of an encode.  There are about two dozen points while splats move, then one after each
 * rate-distortion pass.  This struct never changes. */
typedef struct gscl_trace_point {
    const char *stage; /* name of the current stage; static */
    uint32_t steps;    /* of gradient descent so far; rate-distortion passes add none */
    uint32_t splats;   /* of the fit */
    double seconds;    /* since the encode began */
    double psnr;       /* dB of the rendering at full size, before rounding to samples, against the image */
} gscl_trace_point;

#define GSCL_MAX_STAGES 32       /* rows of gscl_encode_report.stages */
#define GSCL_MAX_TRACE_POINTS 96 /* rows of gscl_encode_report.trace */

/* The results of an encode.  Times are wall-clock times and exclude the time that the convergence trace took. */
typedef struct gscl_encode_report {
    size_t struct_size;  /* set by the caller */
    uint32_t splats;     /* of the file */
    uint64_t bytes;      /* of the file, or of the list of packets */
    double psnr;         /* dB of the decoded file against the image, as gscl_compare (gscl/measure.h) computes it */
    double seconds;      /* total */
    uint32_t trials;     /* complete fits until the target was met: 2 where a smooth image was tried with fewer bytes; a
                            target that is a quality takes short ones, too */
    gscl_blend blend;    /* never AUTO */
    gscl_tune tune;      /* never AUTO */
    size_t effect_count; /* rows of `effects` */
    gscl_effect_decision effects[GSCL_MAX_EFFECTS]; /* one row for each effect that the profile allows */
    uint32_t stage_count;                           /* rows of `stages` */
    gscl_stage_time
        stages[GSCL_MAX_STAGES]; /* in the order of stages; their seconds add up to nearly the total.  Work of an
                                                OpenCL device for density control counts for the fit around it */
    uint32_t trace_count;        /* rows of `trace`; 0 unless the settings request the trace */
    gscl_trace_point trace[GSCL_MAX_TRACE_POINTS]; /* of the last fit */
    double
        ssimulacra2; /* of the decoded file against the image, where the target is SSIMULACRA2 or QUALITY; else NaN */
} gscl_encode_report;

/* Encodes `image` into a new buffer *bytes of *size bytes, which the caller releases with gscl_free: a file or, with
 * settings->packet_size, a list of packets.
 * `settings` may be NULL for the defaults.  `report` may be NULL.  Errors: GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE,
 * _CONFLICT, _IMAGE_SIZE, _IMAGE_NOT_FINITE, _BUDGET_TOO_SMALL, _TARGET_UNREACHABLE, _CANCELLED, and those of memory and
 * the device. */
GSCL_API GSCL_CHECKED gscl_result gscl_encode(gscl_context *context, const gscl_image *image,
                                              const gscl_encode_settings *settings, uint8_t **bytes, size_t *size,
                                              gscl_encode_report *report);

/* ---- Packets ------------------------------------------------------------------------------- */

/* A picture may be divided into packets for radio and other links that lose some of them.  Each can be drawn by itself, any
 * number of them together, and the order in which they come does not matter.  Repair packets besides (setting packet_loss)
 * draw nothing; any of them replaces any other that is lost, where at least one with splats has come.
 *
 * gscl_encode writes a list of packets, which gscl_next_packet takes apart.  Functions that read files read lists, too:
 * of the packets that the first one has the picture of, those that are neither damaged nor repeated.  A receiver that gets
 * packets one by one uses a gscl_decoder. */

#define GSCL_MIN_PACKET_SIZE 40   /* bytes */
#define GSCL_MAX_PACKET_SIZE 1400 /* bytes */
#define GSCL_MAX_PACKETS 256      /* of a picture */

/* Takes the next packet from a list.  *position is 0 before the first call and belongs to this function.  *packet points
 * into the list.  Returns false, and leaves all else as it is, behind the last packet and where the list is cut off or is
 * none. */
GSCL_API bool gscl_next_packet(const uint8_t *list, size_t size, size_t *position, const uint8_t **packet,
                               size_t *packet_size);

/* Appends a packet to a list, which grows: *list is NULL, or a list that the caller releases with gscl_free.  The packet may
 * be damaged; it is not looked into.  Errors: GSCL_ERROR_INVALID_ARGUMENT, _OUT_OF_MEMORY; the list then stays as it is. */
GSCL_API GSCL_CHECKED gscl_result gscl_append_packet(uint8_t **list, size_t *size, const uint8_t *packet,
                                                     size_t packet_size);

/* Returns the bytes of memory that gscl_repair_packets needs; 0 where nothing can be computed or the list is none. */
GSCL_API size_t gscl_repair_memory(const uint8_t *list, size_t size);
/* Computes the packets that a list lacks from its repair packets, as all functions do that read a list in memory of their own.
 * `memory`, of gscl_repair_memory bytes, becomes the list with them, of *repaired_size bytes.  Nothing is allocated.  Errors:
 * GSCL_ERROR_INVALID_ARGUMENT, also where nothing can be computed; GSCL_ERROR_OUT_OF_MEMORY where the memory is too small. */
GSCL_API GSCL_CHECKED gscl_result gscl_repair_packets(const uint8_t *list, size_t size, void *memory,
                                                      size_t memory_size, size_t *repaired_size);

/* Which packet this is, from its bytes alone. */
typedef struct gscl_packet_info {
    size_t struct_size;     /* set by the caller */
    uint32_t identity;      /* of the picture, 0..255 */
    uint32_t number;        /* of the packet, from 0 on; repair packets come after those that have splats */
    uint32_t count;         /* packets of the picture that have splats; 0 in a repair packet, which does not say it */
    uint32_t width, height; /* encoded size of the picture, pixels; 0 in a repair packet */
    uint32_t splats;        /* in this packet */
    bool repair;            /* it has no splats: with others it replaces packets that are lost */
} gscl_packet_info;

/* Reads what a packet says of itself.  The caller sets info->struct_size.  Errors: GSCL_ERROR_NOT_GSCL, _TRUNCATED,
 * _DAMAGED, _CORRUPT, GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE. */
GSCL_API GSCL_CHECKED gscl_result gscl_packet_probe(const uint8_t *packet, size_t size, gscl_packet_info *info);

/* ---- Decoding ------------------------------------------------------------------------------ */

/* The limits protect a server from untrusted files: a file of 30 bytes can describe 16384x16384 pixels.  Both apply to
 * the rectangle that is returned.  gscl_decode checks them as soon as the figures are known, before it allocates pixels
 * or memory of the device; it checks the pixels and the number of splats before it allocates anything. */
typedef struct gscl_decode_settings {
    size_t struct_size;               /* set by gscl_decode_settings_default */
    uint32_t width, height;           /* size at which the whole image is drawn, pixels; default 0: the encoded size */
    uint32_t crop_x, crop_y;          /* top left corner of the returned rectangle in the drawn image; default 0 */
    uint32_t crop_width, crop_height; /* size of that rectangle, pixels; default 0: up to the right and bottom edges */
    gscl_sample sample;               /* of the returned image; default AUTO: U8 or U16, as in the source */
    bool premultiplied;               /* whether returned colours are multiplied by alpha; default false */
    uint64_t max_pixels;              /* largest number of pixels to return; default 0: as many as the format allows,
                                         GSCL_MAX_DIMENSION squared */
    uint64_t max_work; /* largest number of evaluations (see gscl_info.work); default 0: no limit.  A CPU core does
                          about 5e8 a second */
    bool bare;         /* whether the file is bare (gscl_encode_settings.bare), which its bytes do not tell; default
                          false */
    bool partial;      /* whether the file may be cut off: draws the splats that gscl_certain_splats counts.  Damage is
                          then not detected.  Default false: a file that is cut off is refused */
    gscl_progress_callback progress; /* default NULL.  Called before drawing and after each part of the image; the
                                        pixels stay equal.  Parts have 16 rows on the device "host", on others about
                                        5e7 evaluations, but at least 16 rows */
    void *progress_opaque;           /* first argument of `progress` */
    gscl_layout layout; /* of the returned image; default AUTO: grey or RGB, with alpha or without, as the encoded image
                           had them.  Alpha that is not stored is 1.  Where alpha is stored and not returned, pixels are
                           drawn over `background`.  Grey of colours is (R + 2 G + B) / 4, the luma of the file's
                           colours, after that */
    float background[3]; /* R, G and B, 0..1, gamma-encoded like samples: a pixel is colour * alpha + background *
                            (1 - alpha), rounded once; default black.  Not used where alpha is returned or not stored */
} gscl_decode_settings;

/* Sets a struct of struct_size bytes to the defaults.  Programs in C and C++ call gscl_decode_settings_default. */
GSCL_API void gscl_decode_settings_init(gscl_decode_settings *settings, size_t struct_size);
static inline void gscl_decode_settings_default(gscl_decode_settings *settings) {
    gscl_decode_settings_init(settings, sizeof *settings);
}

/* Decodes a file into *image and sets all fields of *image.  When image->pixels is NULL on entry, the library allocates
 * rows without gaps, which the caller releases with gscl_free(image->pixels).  Otherwise the pixels are written to the
 * caller's memory with the caller's stride, bottom-up where it is negative; width, height, channels and sample must
 * then be those of the decoded image: gscl_probe returns those of a decode with the default settings.  The context
 * keeps its device buffers for the next decode.  `settings` may be NULL for the defaults.  Errors: GSCL_ERROR_NOT_GSCL
 * to _UNKNOWN_BLOCK for the file, GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE, _IMAGE_SIZE, _CANCELLED, and those of
 * memory and the device.  A decode that fails may have written to the caller's pixels. */
GSCL_API GSCL_CHECKED gscl_result gscl_decode(gscl_context *context, const uint8_t *bytes, size_t size,
                                              const gscl_decode_settings *settings, gscl_image *image);

/* ---- Pictures that come piece by piece ------------------------------------------------------ */

/* Takes a picture as it comes, by packets or by the bytes of a file, and draws what is there at any time.  It has no device of
 * its own: the context is that of each drawing.  It is used by one thread at a time. */
typedef struct gscl_decoder gscl_decoder;

/* `settings` may be NULL for the defaults; `partial` has no effect.  Errors: GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE,
 * _OUT_OF_MEMORY. */
GSCL_API GSCL_CHECKED gscl_result gscl_decoder_create(gscl_decoder **decoder, const gscl_decode_settings *settings);
/* Frees a decoder and sets *decoder to NULL. */
GSCL_API void gscl_decoder_free(gscl_decoder **decoder);

/* Adds a packet, and copies it.  One that has come before changes nothing.  Any error leaves the picture as it is:
 * GSCL_ERROR_NOT_GSCL, _TRUNCATED, _DAMAGED and _CORRUPT for what is no valid packet, _OTHER_PICTURE for one that does not
 * belong to those before it, _OUT_OF_MEMORY, and GSCL_ERROR_INVALID_ARGUMENT also for a decoder that has bytes of a file. */
GSCL_API GSCL_CHECKED gscl_result gscl_decoder_add_packet(gscl_decoder *decoder, const uint8_t *packet, size_t size);
/* Adds the next bytes of a file, and copies them.  They are looked at when the picture is drawn.  Errors:
 * GSCL_ERROR_INVALID_ARGUMENT, also for a decoder that has packets, and _OUT_OF_MEMORY. */
GSCL_API GSCL_CHECKED gscl_result gscl_decoder_add_bytes(gscl_decoder *decoder, const uint8_t *bytes, size_t size);

/* What has come of a picture. */
typedef struct gscl_decoder_state {
    size_t struct_size;     /* set by the caller */
    uint32_t width, height; /* encoded size, pixels */
    uint32_t splats;        /* that can be drawn */
    uint32_t packets;       /* of the picture that have splats; 0 for a file, and before one of them has come */
    uint32_t drawn;         /* of those, how many can be drawn; with repair packets it may be more than have come */
    uint32_t received;      /* packets that have come, repair packets included, each counted once */
    uint64_t bytes;         /* that are kept */
} gscl_decoder_state;

/* The caller sets state->struct_size.  Errors: GSCL_ERROR_TRUNCATED before the first packet, and while not even the header
 * of a file has come; those of gscl_certain_splats for a file. */
GSCL_API GSCL_CHECKED gscl_result gscl_decoder_inspect(const gscl_decoder *decoder, gscl_decoder_state *state);
/* Draws what has come, as gscl_decode does, with the same errors; GSCL_ERROR_TRUNCATED before there is anything to draw. */
GSCL_API GSCL_CHECKED gscl_result gscl_decoder_draw(gscl_decoder *decoder, gscl_context *context, gscl_image *image);

/* ---- Decoding by rows (without a context and without allocation) --------------------------------- */

/* Receives the next rows of a decoded image, from top to bottom.  `strip` has the whole width of the image, layout,
 * samples and premultiplied colours as gscl_decode would return them; its first row is row y of the image.  It and its
 * pixels are valid during the call, which may write to the pixels.  Returns true to continue and false to stop. */
typedef bool (*gscl_rows_callback)(void *opaque, uint32_t y, const gscl_image *strip);

/* Returns the least memory, in bytes, with which gscl_decode_rows decodes a file.  It needs the start of the file up to the
 * 32nd byte of the picture, which comes after 5 bytes and the blocks before it, or the whole file where that is shorter; of
 * packets it needs the whole list.
 * `settings` and `strip_rows` as for gscl_decode_rows.  `image`: NULL, or receives width, height, channels, layout,
 * sample and premultiplied of the whole decoded image, without pixels.  Errors: GSCL_ERROR_NOT_GSCL to _UNKNOWN_BLOCK
 * for the file, GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE, _IMAGE_SIZE; GSCL_ERROR_OUT_OF_MEMORY where a size_t does
 * not hold the number. */
GSCL_API GSCL_CHECKED gscl_result gscl_rows_memory(const uint8_t *bytes, size_t size,
                                                   const gscl_decode_settings *settings, uint32_t strip_rows,
                                                   gscl_image *image, size_t *memory_size);

/* Decodes a file by rows in memory of the caller, for processors with little memory: it allocates nothing and calls neither
 * the operating system nor the library with a context.  The rows have the samples that gscl_decode returns on the device
 * GSCL_HOST_DEVICE of a library that only decodes; they depend neither on strip_rows nor on the memory.
 * Of a list of packets it draws those that are there: gscl_repair_packets adds those that can be computed.
 *
 * `settings` may be NULL for the defaults; all have their effect but `progress`, which is not called: GSCL_SAMPLE_U8 gives 8
 * bits of files that have 16, too.  `strip_rows`: rows of a strip, of which the last may have fewer; more than the
 * image has are as many as it has, and the strip is then the whole image.  0: as many as the memory allows, 1 to 16.
 * `memory`: at least gscl_rows_memory bytes at any address, whose content is undefined afterwards.  More memory saves time
 * until blocks of 16 rows, or of a strip, are drawn at once, each row of which takes up to 10,400 bytes.  The stack takes
 * about 5 KB besides.  The callback must not be NULL.
 *
 * Errors: those of gscl_rows_memory; GSCL_ERROR_OUT_OF_MEMORY where memory_size is too small, _LIMIT for max_pixels and
 * max_work, _CANCELLED where the callback returned false.  Only _CANCELLED comes after the first call of the callback. */
GSCL_API GSCL_CHECKED gscl_result gscl_decode_rows(const uint8_t *bytes, size_t size,
                                                   const gscl_decode_settings *settings, uint32_t strip_rows,
                                                   void *memory, size_t memory_size, gscl_rows_callback callback,
                                                   void *opaque);

/* ---- Inspecting files (without a context and without OpenCL) -------------------------------- */

/* How functions that only read take a file. */
typedef struct gscl_read_settings {
    size_t struct_size; /* set by gscl_read_settings_default */
    bool bare;          /* whether the file is bare (gscl_encode_settings.bare); default false */
} gscl_read_settings;

/* Sets a struct of struct_size bytes to the defaults.  Programs in C and C++ call gscl_read_settings_default. */
GSCL_API void gscl_read_settings_init(gscl_read_settings *settings, size_t struct_size);
static inline void gscl_read_settings_default(gscl_read_settings *settings) {
    gscl_read_settings_init(settings, sizeof *settings);
}

/* This struct never changes. */
typedef struct gscl_stream_bits {
    const char *name; /* "container", "blocks", "header", "position", ...; static */
    double bits;      /* of the file that it takes */
} gscl_stream_bits;
#define GSCL_MAX_STREAMS 16 /* rows of gscl_info.streams */

/* What a file says about itself. */
typedef struct gscl_info {
    size_t struct_size;                         /* set by the caller */
    uint32_t format_version;                    /* as the file has it */
    uint32_t width, height;                     /* encoded size, pixels */
    uint32_t channels;                          /* of the decoded image, 1..4 */
    gscl_sample sample;                         /* of the source, U8 or U16 */
    gscl_profile profile;                       /* the coding: PAPER means codebooks */
    gscl_blend blend;                           /* never AUTO */
    uint32_t splats;                            /* of the file */
    uint32_t layers;                            /* of a progressive file; else 1 */
    uint32_t packets;                           /* of a list that were read, gscl_inspect only; else 0 */
    uint32_t effects;                           /* bits of gscl_effect that are on */
    uint32_t shape_words, colour_words;         /* codebook sizes, gscl_inspect only; else 0 */
    uint64_t bytes;                             /* of the file */
    size_t stream_count;                        /* rows of `streams`, gscl_inspect only; else 0 */
    gscl_stream_bits streams[GSCL_MAX_STREAMS]; /* streams that are in use; their bits add up to 8 * bytes */
    uint64_t pixels; /* width * height: what max_pixels limits in a decode at the encoded size */
    uint64_t work; /* evaluations of a splat at a pixel in such a decode, what max_work limits: for each splat the area
                        of the rectangle around its outline inside the image, at least 1.  gscl_probe returns an upper
                        bound from the header, splats * pixels; gscl_inspect the figure itself */
} gscl_info;

/* Reads the header of a whole file only, and succeeds where only the check does not match.  `settings` may be NULL for
 * the defaults.  The caller sets info->struct_size.  Errors: GSCL_ERROR_NOT_GSCL to _UNKNOWN_BLOCK,
 * GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE. */
GSCL_API GSCL_CHECKED gscl_result gscl_probe(const uint8_t *bytes, size_t size, const gscl_read_settings *settings,
                                             gscl_info *info);
/* Reads and checks the whole file and counts the bits of each stream.  Errors as gscl_probe, and those of memory. */
GSCL_API GSCL_CHECKED gscl_result gscl_inspect(const uint8_t *bytes, size_t size, const gscl_read_settings *settings,
                                               gscl_info *info);

/* Counts the splats that the first `size` bytes of a file hold: `certain` of `total`, which no further byte can change.
 * gscl_decode with the setting `partial` draws them; splats come in the order of their length, longest first.
 * `settings` may be NULL for the defaults.  Errors: as gscl_inspect; GSCL_ERROR_TRUNCATED while not even the header has
 * come. */
GSCL_API GSCL_CHECKED gscl_result gscl_certain_splats(const uint8_t *bytes, size_t size,
                                                      const gscl_read_settings *settings, uint32_t *certain,
                                                      uint32_t *total);

/* Finds a block of a whole file that is not bare, without reading its picture.  *data points into the file; where the
 * file has no such block, *data is NULL and *data_size is 0.  Errors: GSCL_ERROR_NOT_GSCL to _UNKNOWN_BLOCK,
 * GSCL_ERROR_INVALID_ARGUMENT. */
GSCL_API GSCL_CHECKED gscl_result gscl_find_block(const void *file, size_t size, gscl_block_type type,
                                                  const void **data, size_t *data_size);

/* ---- Fields: splats as data ------------------------------------------------------------------ */

/* One splat as it is drawn.  For the place d = (pixel - (x, y)), with d1 and d2 its coordinates along the axes theta and
 * theta + pi/2,
 *
 *     q      = (d1^2 / sigma1^2 + d2^2 / sigma2^2) / 2
 *     weight = opacity * max(0, exp(-q) - exp(-GSCL_SPLAT_CUTOFF))
 *     colour = colour + wave_amplitude * cos(2 pi (wave_x dx + wave_y dy - wave_phase))         (but not of alpha)
 *
 * This struct never changes. */
typedef struct gscl_splat {
    float x, y;           /* centre, pixels of the encoded size */
    float sigma1, sigma2; /* standard deviations along the axes, pixels */
    float theta;          /* direction of the sigma1 axis, radians, 0..pi from +x towards +y */
    float opacity;        /* 0..1 */
    float colour[4];      /* R, G and B, equal in grey images, premultiplied; then alpha */
    float wave_x, wave_y; /* of the wave, cycles per pixel along x and along y; 0 without a wave */
    float wave_phase;     /* cycles, 0..1 */
    float wave_amplitude; /* of the colours' range 0..1; 0: no wave */
    uint32_t layer;       /* of a progressive file, 0 is the first one; else 0 */
} gscl_splat;

#define GSCL_SPLAT_CUTOFF 7.0               /* q beyond which a splat draws nothing */
#define GSCL_BACKGROUND_WEIGHT (1.0 / 1024) /* of the background in the blend NORMALIZED */
#define GSCL_LARGEST_ALPHA 0.999            /* of a splat in the blend ALPHA */

/* Quantiser steps of the default profile, as a file has them (FORMAT.md, "Dequantisation"): each 0..15, finer ones smaller,
 * but luma, chroma and alpha, where finer ones are larger, and opacity, which is the number of levels less 1; pivot is 0..63.
 * This struct never changes. */
typedef struct gscl_steps {
    uint8_t scale, position, angle, luma, chroma, alpha, opacity, pivot; /* as in the header of a file */
} gscl_steps;

/* Splats, with all that is needed to draw them.  With the splats in their order and w_i their weights at a pixel, a channel of
 * the image is
 *
 *     NORMALIZED  (e background + sum w_i colour_i) / (e + sum w_i),  e = GSCL_BACKGROUND_WEIGHT
 *     ALPHA       for each splat, from the first to the last one: value = value (1 - a_i) + colour_i a_i,
 *                 a_i = min(w_i, GSCL_LARGEST_ALPHA), from value = background on
 *     SUM         background + sum w_i colour_i
 *
 * and is then clamped: alpha to 0..1, colours to 0..alpha (1 without alpha). */
typedef struct gscl_field {
    size_t struct_size;       /* set by the caller */
    uint32_t width, height;   /* of the image, pixels */
    uint32_t channels;        /* of the image: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA */
    gscl_sample sample;       /* of the image that it stands for: U8 or U16 */
    gscl_blend blend;         /* never AUTO */
    float background[4];      /* as gscl_splat.colour */
    bool has_mean_background; /* the background is the mean of the colours of the splats */
    bool has_steps;           /* `steps` are those of the file */
    gscl_steps steps;         /* undefined without has_steps */
    size_t count;             /* of splats */
    gscl_splat *splats;       /* in the order in which they are drawn */
} gscl_field;

/* Reads all splats of a file.  The caller sets field->struct_size and releases field->splats with gscl_free.  `settings` may be
 * NULL for the defaults.  Errors as gscl_inspect. */
GSCL_API GSCL_CHECKED gscl_result gscl_read_field(const uint8_t *bytes, size_t size, const gscl_read_settings *settings,
                                                  gscl_field *field);

/* Sets the axes and the angle of a splat from its covariance, in pixels^2: of a Cholesky factor l that is l11^2, l11 l21 and
 * l21^2 + l22^2.  Returns whether it is the covariance of a Gaussian: finite, and positive definite; the splat stays as it is
 * where it is not. */
GSCL_API bool gscl_splat_set_covariance(gscl_splat *splat, double xx, double xy, double yy);

/* ---- Packing: fields that other programs have fitted ------------------------------------------- */

/* A field has the splats of the caller, as gscl_field describes them, with these differences:
 *  - sigma1 and sigma2 may be 1e-6 to 1e6, theta any direction, x and y anywhere: all numbers are at most 1e6;
 *  - opacity is 0..1 in the blend ALPHA, in NORMALIZED a weight from 0 on, and in SUM any number;
 *  - colours may have any value, and waves any up to one cycle per pixel.
 * What the format has not is replaced by what is nearest to it: splats that draw nothing inside the image are left out; a splat
 * of the blend SUM whose colour is too strong becomes several equal ones, which draw the same; and then
 *  - axes below 1/2 pixel or above 2^15 pixels, or of a ratio above 256, colours that are still too strong, centres outside
 *    the image, weights below a 32nd of the largest one, and an order of the blend ALPHA that is not that of the format (longest
 *    first) are *changed*: the picture must not differ by more than the tolerance.  A centre outside goes to the side of the
 *    image; there the splat becomes narrower and weaker, so that it draws much the same.  In the blend NORMALIZED the file gets
 *    opacities for it, where the field has none.
 * Waves are taken to the nearest that the format has. */

#define GSCL_MAX_REFINE 9

/* What a pack writes, and how. */
typedef struct gscl_pack_settings {
    size_t struct_size; /* set by gscl_pack_settings_default */
    gscl_target
        target; /* AUTO: the finest steps that the format has or, where the field has steps, these; or BPP, BYTES, PSNR,
                           against the reference */
    double target_value; /* default 0 */
    bool passes;         /* whether rate-distortion passes choose codes, and drop splats that are not worth their bits:
                                    fewer bytes at the same quality, in more time; without effect in AUTO and in the blend
                                    ALPHA; default true */
    int refine;          /* 0..GSCL_MAX_REFINE: before the passes the splats move for as many steps as in an encode of
                                    this effort; 0, the default: not at all.  With a target and passes only */
    const gscl_image
        *reference;   /* what PSNR is measured against and passes compare with, of the field's size; default NULL:
                                    the field's own rendering */
    double tolerance; /* root mean square of the difference that changed splats may make, of the range 0..1; default
                                    0.01, a PSNR of 40 dB */
    bool bare;        /* as gscl_encode_settings.bare */
    const gscl_block *blocks;        /* as gscl_encode_settings.blocks */
    gscl_progress_callback progress; /* default NULL */
    void *progress_opaque;           /* first argument of `progress` */
} gscl_pack_settings;

/* Sets a struct of struct_size bytes to the defaults.  Programs in C and C++ call gscl_pack_settings_default. */
GSCL_API void gscl_pack_settings_init(gscl_pack_settings *settings, size_t struct_size);
static inline void gscl_pack_settings_default(gscl_pack_settings *settings) {
    gscl_pack_settings_init(settings, sizeof *settings);
}

/* The results of a pack. */
typedef struct gscl_pack_report {
    size_t struct_size;  /* set by the caller */
    uint64_t bytes;      /* of the file */
    uint64_t splats;     /* of the file */
    uint64_t outside;    /* splats of the field that draw nothing, and are left out */
    uint64_t divided;    /* that became several equal ones */
    uint64_t changed;    /* that are replaced by the nearest ones that the format has */
    double changed_psnr; /* dB: the field with these against the field without; INFINITY where none is */
    double field_psnr;   /* dB: the field's own rendering against the reference; INFINITY where that is the reference */
    double psnr;         /* dB: the decoded file against the reference */
    /* The largest errors of the codes of a splat, without those that passes chose (AUTO, or without passes); else NaN. */
    double position_error; /* pixels */
    double axis_error;     /* share of the axis */
    double colour_error;   /* of the range 0..1 */
    double seconds;        /* total */
} gscl_pack_report;

/* Writes a field as a file, into a new buffer *bytes of *size bytes that the caller releases with gscl_free.  No splat is added
 * but where one is divided.  `settings` may be NULL for the defaults, `report` may be NULL.  Of a field of gscl_read_field it
 * writes, with the defaults, the same picture again.
 *
 * Errors: GSCL_ERROR_INVALID_ARGUMENT for a field with a splat that is none, which the message names by its number, from 0 on;
 * GSCL_ERROR_FIELD where the format does not have it; GSCL_ERROR_IMAGE_SIZE, _BUDGET_TOO_SMALL, _TARGET_UNREACHABLE, _CONFLICT,
 * _CANCELLED, _STRUCT_SIZE, and those of memory and the device. */
GSCL_API GSCL_CHECKED gscl_result gscl_pack(gscl_context *context, const gscl_field *field,
                                            const gscl_pack_settings *settings, uint8_t **bytes, size_t *size,
                                            gscl_pack_report *report);

#ifdef __cplusplus
}
#endif
#endif
