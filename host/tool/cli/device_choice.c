#define _POSIX_C_SOURCE 200809L
#include "cli/device_choice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/build_notice.h"
#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/pocl_cache.h"

#define MAX_PATH 1024 /* bytes, the NUL included */

static void log_message(void *opaque, gscl_log_level level, const char *message) {
    (void)opaque;
    /* Errors also come back as results; report_result reports them, once. */
    if (level != GSCL_LOG_ERROR)
        report_note("%s", message);
}

/* Advice on an error, printed after the library's text. */
static const char *advice(gscl_result result) {
    switch (result) {
    case GSCL_ERROR_NO_PLATFORM:
        return "; install one, for example the package pocl-opencl-icd";
    case GSCL_ERROR_UNKNOWN_DEVICE:
        return "; 'gscl devices' lists them";
    default:
        return "";
    }
}

/* The option that raises the limit of an error, as the library names it. */
static const char *advice_on_limit(const char *detail) {
    return strstr(detail, "max_pixels") ? "; --max-pixels raises this limit" : "; --max-work raises this limit";
}

/* Whether the cause may be that PoCL cannot write to its cache. */
static bool may_be_pocl_cache(const gscl_context *context, gscl_result result) {
    if (result == GSCL_ERROR_NO_PLATFORM)
        return true;
    return (result == GSCL_ERROR_KERNEL_BUILD || result == GSCL_ERROR_DEVICE_FAILED) && context &&
           strcmp(gscl_context_device(context)->platform_name, "Portable Computing Language") == 0;
}

void explain_result(const gscl_context *context, gscl_result result, char text[EXPLANATION_SIZE]) {
    const char *detail = context ? gscl_context_message(context) : "";
    if (may_be_pocl_cache(context, result) && pocl_cache_explain(text, EXPLANATION_SIZE))
        return;
    if (*detail)
        snprintf(text, EXPLANATION_SIZE, "%s%s", detail, result == GSCL_ERROR_LIMIT ? advice_on_limit(detail) : "");
    else
        snprintf(text, EXPLANATION_SIZE, "%s%s", gscl_result_text(result), advice(result));
}

int report_result(const gscl_context *context, const char *subject, gscl_result result) {
    /* A signal decides whatever the result is: kernel compilers react to signals too, and fail with errors of their own. */
    if (interrupt_pending()) {
        report_error(subject, "interrupted; its output was not written");
        return EXIT_SIGNAL + interrupt_pending();
    }
    char text[EXPLANATION_SIZE];
    explain_result(context, result, text);
    report_error(subject, "%s", text);
    return result == GSCL_ERROR_CONFLICT ? EXIT_USAGE : EXIT_FAILURE;
}

/* Writes the folder of built kernels; an empty text where the environment names none. */
static void cache_folder(char folder[MAX_PATH]) {
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    int length = MAX_PATH;
    if (cache && cache[0] == '/') /* by the rule of XDG relative names do not count */
        length = snprintf(folder, MAX_PATH, "%s/gscl", cache);
    else if (home && home[0] == '/')
        length = snprintf(folder, MAX_PATH, "%s/.cache/gscl", home);
    if (length >= MAX_PATH)
        folder[0] = '\0';
}

gscl_result create_context(const device_choice *choice, gscl_context **context) {
    char folder[MAX_PATH];
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = choice->device;
    settings.mapping = (gscl_mapping)choice->mapping;
    settings.timing = choice->timing;
    if (!choice->no_cache) {
        cache_folder(folder);
        settings.cache_folder = folder;
    }
    if (!choice->quiet)
        settings.build = build_notice;
    if (choice->verbose)
        settings.log = log_message;
    return gscl_context_create(context, &settings);
}

int open_device(const device_choice *choice, gscl_context **context) {
    const gscl_result result = create_context(choice, context);
    if (result == GSCL_OK)
        return EXIT_SUCCESS;
    const int status = report_result(*context, choice->device ? choice->device : "OpenCL", result);
    gscl_context_free(context);
    return status;
}

static bool has_opencl(void) {
    gscl_device_info *devices = NULL;
    const bool found = gscl_list_devices(&devices) == GSCL_OK;
    gscl_free(devices);
    return found;
}

static bool host_is_faster(uint64_t pixels) {
    const uint64_t megapixel = 1000000;
    return pixels <= HOST_MEGAPIXELS * megapixel ||
           (pixels <= HOST_MEGAPIXELS_UNBUILT * megapixel && !pocl_cache_exists());
}

int open_decoder(const device_choice *choice, uint64_t pixels, gscl_context **context) {
    device_choice chosen = *choice;
    if (!choice->device && choice->mapping == GSCL_MAPPING_AUTO && (host_is_faster(pixels) || !has_opencl()))
        chosen.device = GSCL_HOST_DEVICE;
    return open_device(&chosen, context);
}
