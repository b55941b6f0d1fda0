/* gscl compare: measures of the difference between two images. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "cli/device_choice.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/names.h"
#include "cli/options.h"
#include "cli/read_file.h"
#include "commands/command.h"
#include "image/image_file.h"

/* A value of NaN means that the image is too small for the measure. */
static void print_measure(const char *name, double value, int decimals, const char *unit) {
    if (isnan(value))
        printf("%-16s%10s\n", name, "too small");
    else
        printf("%-16s%10.*f%s\n", name, decimals, value, unit);
}

static void print_text(const gscl_comparison *comparison) {
    print_measure("PSNR", comparison->psnr, 3, " dB");
    print_measure("SSIM", comparison->ssim, 5, "");
    print_measure("MS-SSIM", comparison->ms_ssim, 5, "");
    print_measure("SSIMULACRA 2", comparison->ssimulacra2, 2, "");
    print_measure("MSE", comparison->mse, 4, "");
    print_measure("max difference", comparison->max_difference, 2, " of 255");
}

static void write_json(const char *a, const char *b, const gscl_comparison *comparison) {
    json_writer json;
    json_start(&json, stdout);
    json_open_object(&json, NULL);
    json_string(&json, "a", a);
    json_string(&json, "b", b);
    json_real(&json, "psnr", comparison->psnr);
    json_real(&json, "ssim", comparison->ssim);
    json_real(&json, "ms_ssim", comparison->ms_ssim);
    json_real(&json, "ssimulacra2", comparison->ssimulacra2);
    json_real(&json, "mse", comparison->mse);
    json_real(&json, "max_difference", comparison->max_difference);
    json_close_object(&json);
}

static bool are_comparable(const char *name_a, const gscl_image *a, const char *name_b, const gscl_image *b) {
    if (a->width != b->width || a->height != b->height)
        return report_error(name_b, "is %u x %u pixels but %s is %u x %u; both must have the same size", b->width,
                            b->height, name_a, a->width, a->height);
    if (a->channels != b->channels)
        return report_error(name_b, "is %s but %s is %s; both must have the same channels", channels_name(b->channels),
                            name_a, channels_name(a->channels));
    return true;
}

static int compare_images(const char *name_a, const gscl_image *a, const char *name_b, const gscl_image *b,
                          bool as_json) {
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    if (!are_comparable(name_a, a, name_b, b))
        return EXIT_FAILURE;
    const gscl_result result = gscl_compare(a, b, &comparison);
    if (result != GSCL_OK)
        return report_result(NULL, name_b, result);
    if (as_json)
        write_json(name_a, name_b, &comparison);
    else
        print_text(&comparison);
    return EXIT_SUCCESS;
}

static int compare_files(const char *name_a, const char *name_b, bool as_json) {
    gscl_image a = {0}, b = {0};
    int status = EXIT_FAILURE;
    if (image_read(name_a, &a) && image_read(name_b, &b))
        status = compare_images(input_label(name_a), &a, input_label(name_b), &b, as_json);
    free(a.pixels);
    free(b.pixels);
    return status;
}

int command_compare(int argc, char **argv) {
    bool as_json = false;
    const option_spec options[] = {
        {.name = "json",
         .kind = OPTION_FLAG,
         .value = &as_json,
         .help = "write JSON; null stands for an infinite PSNR and for measures that need a larger image"},
    };
    const option_command command = {
        .name = "compare",
        .usage = "A B [--json]",
        .about =
            "Measures the difference between two images of the same size and channels: PSNR over all channels, SSIM\n"
            "and MS-SSIM as means over the channels, and SSIMULACRA 2 of B as a version of A (100: equal; colours\n"
            "taken as sRGB).  Colours are multiplied by alpha first.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 2,
        .max_operands = 2,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    return compare_files(argv[first], argv[first + 1], as_json);
}
