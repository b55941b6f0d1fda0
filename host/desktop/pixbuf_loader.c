/* The gdk-pixbuf loader: reads gscl files as they arrive, at the size that the program asks for, and writes them.
 *
 * It draws on the processor (the library's device "host"), and refuses what would need more memory or time than a viewer
 * should spend on a file that nobody has checked. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GDK_PIXBUF_ENABLE_BACKEND
#include <gdk-pixbuf/gdk-pixbuf.h>
#include <glib.h>

#include <lcms2.h>

#include <gscl/gscl.h>

#include "colours/cicp.h"

#define MAX_FILE_BYTES (64u << 20)     /* more than a file of the largest number of splats has */
#define MAX_PIXELS (64u << 20)         /* of one picture at the size that is drawn: 256 MiB */
#define MAX_WORK UINT64_C(20000000000) /* evaluations: about 40 s of one core */
#define FIRST_DRAW 64                  /* bytes after which a file that arrives in parts is drawn first */

/* What loading has come to. */
typedef struct gscl_loader {
    GdkPixbufModuleSizeFunc size_func;
    GdkPixbufModulePreparedFunc prepared_func;
    GdkPixbufModuleUpdatedFunc updated_func;
    gpointer user_data;
    GByteArray *bytes;
    GdkPixbuf *pixbuf; /* NULL until the header has come */
    guint next_draw;   /* number of bytes after which a part is drawn again */
    bool unwanted;     /* whether the program wants no pixels: it has set a size of 0 */
} gscl_loader;

/* ---- Errors ------------------------------------------------------------------------------------ */

static gint error_code(gscl_result result) {
    switch (result) {
    case GSCL_ERROR_OUT_OF_MEMORY:
    case GSCL_ERROR_LIMIT:
        return GDK_PIXBUF_ERROR_INSUFFICIENT_MEMORY;
    case GSCL_ERROR_NOT_GSCL:
    case GSCL_ERROR_NEWER_VERSION:
    case GSCL_ERROR_UNKNOWN_BLOCK:
        return GDK_PIXBUF_ERROR_UNKNOWN_TYPE;
    case GSCL_ERROR_TRUNCATED:
    case GSCL_ERROR_DAMAGED:
    case GSCL_ERROR_CORRUPT:
        return GDK_PIXBUF_ERROR_CORRUPT_IMAGE;
    default:
        return GDK_PIXBUF_ERROR_FAILED;
    }
}

/* Sets the library's text as the error.  `context` may be NULL.  Returns FALSE. */
static gboolean fail(GError **error, const gscl_context *context, gscl_result result) {
    const char *detail = context ? gscl_context_message(context) : "";
    g_set_error(error, GDK_PIXBUF_ERROR, error_code(result), "gscl: %s", *detail ? detail : gscl_result_text(result));
    return FALSE;
}

/* ---- Drawing ----------------------------------------------------------------------------------- */

/* Draws all bytes that have come into the pixbuf, which has no grey. */
static gscl_result draw_into(gscl_loader *loader, gscl_context *context, bool partial) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.sample = GSCL_SAMPLE_U8;
    settings.layout = gdk_pixbuf_get_has_alpha(loader->pixbuf) ? GSCL_LAYOUT_RGBA : GSCL_LAYOUT_RGB;
    settings.width = (uint32_t)gdk_pixbuf_get_width(loader->pixbuf);
    settings.height = (uint32_t)gdk_pixbuf_get_height(loader->pixbuf);
    settings.max_pixels = MAX_PIXELS;
    settings.max_work = MAX_WORK;
    settings.partial = partial;
    gscl_image image = {.width = settings.width,
                        .height = settings.height,
                        .channels = (uint32_t)gdk_pixbuf_get_n_channels(loader->pixbuf),
                        .sample = GSCL_SAMPLE_U8,
                        .stride = gdk_pixbuf_get_rowstride(loader->pixbuf),
                        .pixels = gdk_pixbuf_get_pixels(loader->pixbuf)};
    return gscl_decode(context, loader->bytes->data, loader->bytes->len, &settings, &image);
}

/* Draws what has come and announces it. */
static gboolean draw(gscl_loader *loader, bool partial, GError **error) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    gscl_result result = gscl_context_create(&context, &settings);
    if (result == GSCL_OK)
        result = draw_into(loader, context, partial);
    const gboolean ok = result == GSCL_OK || fail(error, context, result);
    gscl_context_free(&context);
    if (ok && loader->updated_func)
        loader->updated_func(loader->pixbuf, 0, 0, gdk_pixbuf_get_width(loader->pixbuf),
                             gdk_pixbuf_get_height(loader->pixbuf), loader->user_data);
    return ok;
}

/* ---- Loading ----------------------------------------------------------------------------------- */

/* Makes the pixbuf, clear, at the size that the program chooses. */
static gboolean prepare(gscl_loader *loader, const gscl_info *info, GError **error) {
    gint width = (gint)info->width, height = (gint)info->height;
    if (loader->size_func)
        loader->size_func(&width, &height, loader->user_data);
    loader->unwanted = width == 0 || height == 0;
    if (loader->unwanted)
        return TRUE;
    if (width < 0 || height < 0 || width > GSCL_MAX_DIMENSION || height > GSCL_MAX_DIMENSION ||
        (guint64)width * (guint64)height > MAX_PIXELS) {
        g_set_error(error, GDK_PIXBUF_ERROR, GDK_PIXBUF_ERROR_INSUFFICIENT_MEMORY,
                    "gscl: a picture of %d x %d pixels is too large; at most %u pixels are drawn", width, height,
                    MAX_PIXELS);
        return FALSE;
    }
    loader->pixbuf = gdk_pixbuf_new(GDK_COLORSPACE_RGB, info->channels % 2 == 0, 8, width, height);
    if (!loader->pixbuf)
        return fail(error, NULL, GSCL_ERROR_OUT_OF_MEMORY);
    gdk_pixbuf_fill(loader->pixbuf, 0);
    if (loader->prepared_func)
        loader->prepared_func(loader->pixbuf, NULL, loader->user_data);
    return TRUE;
}

/* Looks for the header in what has come. */
static gboolean find_header(gscl_loader *loader, GError **error) {
    gscl_info info = {.struct_size = sizeof info};
    const gscl_result result = gscl_probe(loader->bytes->data, loader->bytes->len, NULL, &info);
    if (result == GSCL_OK)
        return prepare(loader, &info, error);
    /* Less than the magic bytes is not yet known to be a gscl file. */
    return result == GSCL_ERROR_TRUNCATED || loader->bytes->len < 4 || fail(error, NULL, result);
}

static gpointer begin_load(GdkPixbufModuleSizeFunc size_func, GdkPixbufModulePreparedFunc prepared_func,
                           GdkPixbufModuleUpdatedFunc updated_func, gpointer user_data, GError **error) {
    (void)error;
    gscl_loader *loader = g_new0(gscl_loader, 1);
    loader->size_func = size_func;
    loader->prepared_func = prepared_func;
    loader->updated_func = updated_func;
    loader->user_data = user_data;
    loader->bytes = g_byte_array_new();
    loader->next_draw = FIRST_DRAW;
    return loader;
}

static gboolean load_increment(gpointer context, const guchar *bytes, guint size, GError **error) {
    gscl_loader *loader = context;
    /* What had come before is drawn only now, so that a file that comes in one part is drawn once. */
    if (loader->pixbuf && loader->bytes->len >= loader->next_draw) {
        loader->next_draw = 2 * loader->bytes->len;
        if (!draw(loader, true, error))
            return FALSE;
    }
    if (size > MAX_FILE_BYTES - loader->bytes->len) {
        g_set_error(error, GDK_PIXBUF_ERROR, GDK_PIXBUF_ERROR_INSUFFICIENT_MEMORY,
                    "gscl: the file is too large; at most %u bytes are read", MAX_FILE_BYTES);
        return FALSE;
    }
    g_byte_array_append(loader->bytes, bytes, size);
    return loader->pixbuf || loader->unwanted || find_header(loader, error);
}

/* ---- Colours ----------------------------------------------------------------------------------- */

#define PROFILE_OPTION "icc-profile" /* of pixbufs and of saving: the bytes of a profile in base64 */

static const void *find_block(const gscl_loader *loader, gscl_block_type type, size_t *size) {
    const void *data;
    const gscl_result result = gscl_find_block(loader->bytes->data, loader->bytes->len, type, &data, size);
    return result == GSCL_OK && *size > 0 ? data : NULL;
}

static void attach_bytes(GdkPixbuf *pixbuf, const void *profile, gsize size) {
    char *text = g_base64_encode(profile, size);
    gdk_pixbuf_set_option(pixbuf, PROFILE_OPTION, text);
    g_free(text);
}

/* Attaches the profile of code points, which gdk-pixbuf does not have.  HDR has none. */
static void attach_code_points(GdkPixbuf *pixbuf, const uint8_t cicp[2]) {
    const cmsContext context = cmsCreateContext(NULL, NULL);
    const cmsHPROFILE profile = context ? profile_of_cicp(context, cicp, 3) : NULL;
    cmsUInt32Number size = 0;
    if (profile && cmsSaveProfileToMem(profile, NULL, &size)) {
        void *bytes = g_malloc(size);
        if (cmsSaveProfileToMem(profile, bytes, &size))
            attach_bytes(pixbuf, bytes, size);
        g_free(bytes);
    }
    if (profile)
        cmsCloseProfile(profile);
    if (context)
        cmsDeleteContext(context);
}

static void attach_colours(const gscl_loader *loader) {
    size_t size;
    const void *profile = find_block(loader, GSCL_BLOCK_ICC, &size);
    if (profile) {
        attach_bytes(loader->pixbuf, profile, size);
        return;
    }
    const uint8_t *cicp = find_block(loader, GSCL_BLOCK_COLOUR_SPACE, &size);
    if (cicp && size == 2)
        attach_code_points(loader->pixbuf, cicp);
}

/* ---- Ending ------------------------------------------------------------------------------------ */

static gboolean stop_load(gpointer context, GError **error) {
    gscl_loader *loader = context;
    gboolean ok = TRUE;
    if (loader->pixbuf) {
        ok = draw(loader, false, error);
        if (ok)
            attach_colours(loader);
        else if (loader->bytes->len > FIRST_DRAW)
            draw(loader, true, NULL); /* what there is of a file that is cut off stays in sight */
    } else if (!loader->unwanted)
        ok = fail(error, NULL, loader->bytes->len < 4 ? GSCL_ERROR_NOT_GSCL : GSCL_ERROR_TRUNCATED);
    g_clear_object(&loader->pixbuf);
    g_byte_array_unref(loader->bytes);
    g_free(loader);
    return ok;
}

/* ---- Saving ------------------------------------------------------------------------------------ */

typedef struct target_option {
    const char *key;
    gscl_target target;
    double least, most; /* value */
} target_option;

static const target_option targets[] = {{"quality", GSCL_TARGET_QUALITY, 0, 100},
                                        {"bytes", GSCL_TARGET_BYTES, 0, HUGE_VAL},
                                        {"bpp", GSCL_TARGET_BPP, 0, HUGE_VAL},
                                        {"psnr", GSCL_TARGET_PSNR, 0, HUGE_VAL},
                                        {"ssimulacra2", GSCL_TARGET_SSIMULACRA2, GSCL_MIN_SSIMULACRA2, 100}};

/* NULL: the key is none of a target. */
static const target_option *target_of(const char *key) {
    for (gsize i = 0; i < G_N_ELEMENTS(targets); i++)
        if (strcmp(key, targets[i].key) == 0)
            return &targets[i];
    return NULL;
}

/* What is saved beside the pixels: the colours of the pixbuf, as its loader or its program gives them. */
typedef struct save_options {
    gscl_encode_settings settings;
    gscl_block icc; /* data allocated with GLib; NULL: none */
} save_options;

static gboolean take_profile(const char *text, save_options *options) {
    gsize size;
    guchar *bytes = g_base64_decode(text, &size);
    g_free((void *)options->icc.data);
    options->icc = (gscl_block){.type = GSCL_BLOCK_ICC, .data = bytes, .size = size};
    options->settings.blocks = &options->icc;
    return size > 0 && size <= GSCL_MAX_BLOCK_SIZE;
}

static gboolean bad_option(GError **error, const char *key, const char *value) {
    g_set_error(error, GDK_PIXBUF_ERROR, GDK_PIXBUF_ERROR_BAD_OPTION,
                "gscl: the option %s cannot be '%.40s'; there are preset (tiny, preview, small, good), quality (0 to "
                "100), bytes, bpp, psnr, ssimulacra2 (-100 to 100), effort (0 to 9), tune (auto, psnr, ssim, visual) "
                "and icc-profile (in base64, at most %d bytes)",
                key, value, GSCL_MAX_BLOCK_SIZE);
    return FALSE;
}

static gboolean take_tune(const char *value, gscl_encode_settings *settings) {
    static const char *const words[] = {"auto", "psnr", "ssim", "visual", NULL};
    for (int i = 0; words[i]; i++) {
        if (strcmp(value, words[i]) == 0) {
            settings->tune = (gscl_tune)i;
            return TRUE;
        }
    }
    return FALSE;
}

static gboolean take_preset(const char *value, gscl_encode_settings *settings) {
    gscl_preset preset = GSCL_PRESET_TINY;
    while (gscl_preset_name(preset) && strcmp(value, gscl_preset_name(preset)) != 0)
        preset++;
    return gscl_encode_settings_preset(settings, preset) == GSCL_OK;
}

/* Options count in their order: the last target, and an effort behind a preset. */
static gboolean take_option(const char *key, const char *value, save_options *options) {
    gscl_encode_settings *settings = &options->settings;
    char *end;
    const double number = g_ascii_strtod(value, &end);
    const gboolean is_number = end != value && *end == '\0' && isfinite(number);
    const target_option *target = target_of(key);
    if (target) {
        settings->target = target->target;
        settings->target_value = number;
        return is_number && number >= target->least && number <= target->most;
    }
    if (strcmp(key, "effort") == 0) {
        if (!is_number || number < 0 || number > GSCL_MAX_EFFORT || number != floor(number))
            return FALSE;
        settings->effort = (int)number;
        return TRUE;
    }
    if (strcmp(key, PROFILE_OPTION) == 0)
        return take_profile(value, options);
    if (strcmp(key, "preset") == 0)
        return take_preset(value, settings);
    return strcmp(key, "tune") == 0 && take_tune(value, settings);
}

static gboolean is_save_option_supported(const gchar *key) {
    static const char *const others[] = {"preset", "effort", "tune", PROFILE_OPTION, NULL};
    return target_of(key) || g_strv_contains(others, key);
}

static gboolean take_options(GdkPixbuf *pixbuf, gchar **keys, gchar **values, save_options *options, GError **error) {
    const char *profile = gdk_pixbuf_get_option(pixbuf, PROFILE_OPTION);
    gscl_encode_settings_default(&options->settings);
    if (profile && !take_profile(profile, options))
        return bad_option(error, PROFILE_OPTION, profile);
    for (; keys && *keys; keys++, values++) {
        if (!take_option(*keys, *values, options))
            return bad_option(error, *keys, *values);
    }
    return TRUE;
}

static gboolean encode_and_save(GdkPixbufSaveFunc save, gpointer user_data, const GdkPixbuf *pixbuf,
                                const gscl_encode_settings *settings, GError **error) {
    gscl_context *context;
    uint8_t *bytes = NULL;
    size_t size = 0;
    const gscl_image image = {.width = (uint32_t)gdk_pixbuf_get_width(pixbuf),
                              .height = (uint32_t)gdk_pixbuf_get_height(pixbuf),
                              .channels = (uint32_t)gdk_pixbuf_get_n_channels(pixbuf),
                              .sample = GSCL_SAMPLE_U8,
                              .stride = gdk_pixbuf_get_rowstride(pixbuf),
                              .pixels = gdk_pixbuf_get_pixels(pixbuf)};
    gscl_result result = gscl_context_create(&context, NULL);
    if (result == GSCL_OK)
        result = gscl_encode(context, &image, settings, &bytes, &size, NULL);
    const gboolean ok =
        result == GSCL_OK ? save((const gchar *)bytes, size, error, user_data) : fail(error, context, result);
    gscl_free(bytes);
    gscl_context_free(&context);
    return ok;
}

static gboolean save_to_callback(GdkPixbufSaveFunc save, gpointer user_data, GdkPixbuf *pixbuf, gchar **keys,
                                 gchar **values, GError **error) {
    save_options options = {.icc.data = NULL};
    gboolean ok = take_options(pixbuf, keys, values, &options, error);
    if (ok) {
        GdkPixbuf *upright = gdk_pixbuf_apply_embedded_orientation(pixbuf); /* as its loader found it in the file */
        ok = upright && encode_and_save(save, user_data, upright, &options.settings, error);
        g_clear_object(&upright);
    }
    g_free((void *)options.icc.data);
    return ok;
}

/* ---- The module -------------------------------------------------------------------------------- */

G_MODULE_EXPORT void fill_vtable(GdkPixbufModule *module);
G_MODULE_EXPORT void fill_info(GdkPixbufFormat *info);

void fill_vtable(GdkPixbufModule *module) {
    module->begin_load = begin_load;
    module->load_increment = load_increment;
    module->stop_load = stop_load;
    module->save_to_callback = save_to_callback;
    module->is_save_option_supported = is_save_option_supported;
}

void fill_info(GdkPixbufFormat *info) {
    static GdkPixbufModulePattern signature[] = {{"\xC7gsc", NULL, 100}, {NULL, NULL, 0}};
    static gchar *types[] = {"image/x-gscl", NULL};
    static gchar *extensions[] = {"gscl", NULL};
    info->name = "gscl";
    info->signature = signature;
    info->description = "gscl image";
    info->mime_types = types;
    info->extensions = extensions;
    info->flags = GDK_PIXBUF_FORMAT_WRITABLE | GDK_PIXBUF_FORMAT_THREADSAFE;
    info->license = "BSD";
}
