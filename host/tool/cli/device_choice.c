#define _POSIX_C_SOURCE 200809L
#include "cli/device_choice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/build_notice.h"
#include "cli/device_list.h"
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

static bool has_opencl(void) {
    gscl_device_info *devices = NULL;
    const bool found = list_encoders(&devices) == GSCL_OK && find_opencl(devices);
    gscl_free(devices);
    return found;
}

/* Whether the cause may be that PoCL cannot write to its cache: then it offers no device, or fails to build kernels. */
static bool may_be_pocl_cache(const gscl_context *context, gscl_result result) {
    if (result == GSCL_ERROR_NO_PLATFORM || result == GSCL_ERROR_UNKNOWN_DEVICE)
        return !has_opencl();
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
    settings.threads = (int)choice->threads;
    if (choice->device ? !is_host_device(choice->device) : choice->mapping != GSCL_MAPPING_AUTO)
        pocl_cache_prepare(choice->quiet);
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

/* Whether "host" draws a picture in place of the default device, which may be "host", too. */
static bool host_draws(uint64_t pixels) {
    const uint64_t megapixel = 1000000;
    gscl_device_info *devices = NULL;
    if (pixels <= HOST_MEGAPIXELS * megapixel)
        return true;
    const gscl_result result = list_encoders(&devices);
    const bool has_kernels = find_host(devices), has_opencl_device = find_opencl(devices);
    gscl_free(devices);
    if (result != GSCL_OK || has_kernels)
        return false;
    return !has_opencl_device || (pixels <= HOST_MEGAPIXELS_UNBUILT * megapixel && !pocl_cache_exists());
}

int open_decoder(const device_choice *choice, uint64_t pixels, gscl_context **context) {
    device_choice chosen = *choice;
    if (!choice->device && choice->mapping == GSCL_MAPPING_AUTO && host_draws(pixels))
        chosen.device = GSCL_HOST_DEVICE;
    return open_device(&chosen, context);
}

int choose_opencl_device(const char *command, const char *purpose, device_choice *choice, opencl_device_id id) {
    gscl_device_info *devices = NULL;
    if (is_host_device(choice->device))
        return report_usage(command, "--device host does not apply: %s; leave it out or name an OpenCL device",
                            purpose);
    if (choice->device)
        return EXIT_SUCCESS;
    const gscl_result result = list_encoders(&devices);
    const gscl_device_info *opencl = find_opencl(devices);
    if (opencl)
        choice->device = memcpy(id, opencl->id, sizeof opencl->id);
    gscl_free(devices);
    if (result != GSCL_OK)
        return report_result(NULL, command, result);
    if (choice->device)
        return EXIT_SUCCESS;
    char text[EXPLANATION_SIZE];
    if (pocl_cache_explain(text, sizeof text))
        report_error("OpenCL", "%s", text);
    else
        report_error("OpenCL",
                     "no OpenCL device was found; %s; install the packages ocl-icd-libopencl1 and "
                     "pocl-opencl-icd",
                     purpose);
    return EXIT_FAILURE;
}
