/* gscl encode: encodes images as gscl files. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <gscl/gscl.h>

#include "cli/exit_code.h"
#include "cli/message.h"
#include "cli/names.h"
#include "cli/options.h"
#include "cli/output_file.h"
#include "commands/batch_devices.h"
#include "commands/command.h"
#include "commands/effect_list.h"
#include "commands/encode_batch.h"
#include "host/system/files.h"
#include "image/image_format.h"

typedef struct encode_options {
    encode_batch batch;
    uint64_t bytes, splats, effort, codebook, seed, packet_size, packet_count, packet_identity;
    double bpp, psnr, ssimulacra2, quality;
    const char *effects;
    uint32_t effects_on, effects_off;
    int preset, profile, blend, loss, tune; /* indices into their words, which are the library's enums */
    int metadata;                           /* index into metadata_words */
    bool has_preset, has_bytes, has_bpp, has_psnr, has_ssimulacra2, has_quality, has_splats, has_effort, has_codebook;
} encode_options;

enum { METADATA_NONE, METADATA_EXIF, METADATA_ALL };
static const char *const metadata_words[] = {"none", "exif", "all", NULL};

#define ABOUT_RUNS                                                                                                     \
    "A run over many images:\n"                                                                                        \
    "\n"                                                                                                               \
    "  find photos -name '*.jpg' -print0 |\n"                                                                          \
    "      gscl encode -0 --files-from - --out-dir coded --keep-tree --skip-existing --jsonl coded.jsonl\n"            \
    "\n"                                                                                                               \
    "encodes the images of the command line first, then those of the list.  A bad image prints one line, and the run " \
    "goes\n"                                                                                                           \
    "on; the last line is a summary, and the exit code is 3 when some failed.  An output appears whole or not at "     \
    "all, so\n"                                                                                                        \
    "after a kill the same command goes on: it encodes what has no output, tries again what failed, and repeats "      \
    "nothing.\n"                                                                                                       \
    "Empty lines of a list count for nothing.  With --keep-tree a leading / is left out, and .. is refused; without "  \
    "it\n"                                                                                                             \
    "only the first of two images with the same output is encoded.  A shard depends on the output's name below "       \
    "--out-dir\n"                                                                                                      \
    "alone, not on the list; give each shard a report of its own, which can be joined with cat.  Memory does not "     \
    "grow with\n"                                                                                                      \
    "the number of images: what is done is kept in a file in $TMPDIR, 64 bytes for each image.\n"                      \
    "\n"                                                                                                               \
    "Members of a line of the report, null where unknown: id (of output and input), status (ok, skipped, failed or "   \
    "crashed), "                                                                                                       \
    "input,\n"                                                                                                         \
    "output, code (0, the gscl_result of gscl.h, or 100: no output for this name, 101: the input cannot be read, "     \
    "102: the\n"                                                                                                       \
    "output cannot be written, 103: another input has this output, 104: the library that reads it has crashed, and "   \
    "later runs leave it out), message, bytes, width, height, splats, psnr, "                                          \
    "ssimulacra2 (where it is the target),\n"                                                                          \
    "seconds, device.  Lines are in the order in which images end; the last line of an image counts, and its older "   \
    "ones are removed\n"                                                                                               \
    "when a run ends."

#define MIN_CODEBOOK 2
#define MAX_CODEBOOK 1024
#define MAX_SHARDS 1000000

/* Whether this names a coded picture. */
static bool is_coded_name(const char *name) {
    const char *suffix = name_suffix(name);
    return strcasecmp(suffix, ".gscl") == 0 || strcasecmp(suffix, ".gsclp") == 0;
}

/* The second of two operands that names a coded picture is the output.  One that does not exist and has no suffix of an image
 * that gscl writes is a mistyped output rather than an input. */
static int take_output_operand(encode_batch *batch) {
    if (batch->count != 2 || batch->output || batch->out_dir || batch->files_from)
        return EXIT_SUCCESS;
    const char *last = batch->inputs[1];
    if (is_coded_name(last))
        return output_take_operand("encode", batch->inputs, &batch->count, &batch->output);
    if (strcmp(last, "-") != 0 && !system_exists(last) && !image_format_has_suffix(last))
        return report_usage("encode", "%s does not exist; an output ends with .gscl, or is named with -o", last);
    return EXIT_SUCCESS;
}

static option_outcome parse_encode(encode_options *encode, int argc, char **argv) {
    encode_batch *batch = &encode->batch;
    const option_spec options[] = {
        {.name = "output",
         .letter = 'o',
         .kind = OPTION_TEXT,
         .value = &batch->output,
         .argument = "FILE",
         .help =
             "file to write; - is standard output (default: the second of two operands, where it ends with .gscl and "
             "does not exist; else IN with its suffix replaced by .gscl)"},
        {.name = "out-dir",
         .kind = OPTION_TEXT,
         .value = &batch->out_dir,
         .argument = "DIR",
         .help = "folder for the outputs, which is made (default: beside each input)"},
        {.name = "keep-tree",
         .kind = OPTION_FLAG,
         .value = &batch->keep_tree,
         .help = "make the folders of each input's name in --out-dir, too (default: all outputs side by side)"},
        {.name = "files-from",
         .kind = OPTION_TEXT,
         .value = &batch->files_from,
         .argument = "FILE",
         .help = "encode the images named in FILE, too, one on each line; - is standard input"},
        {.name = "null",
         .letter = '0',
         .kind = OPTION_FLAG,
         .value = &batch->null,
         .help = "the names in --files-from end with NUL, as find -print0 writes them"},
        {.name = "jobs",
         .kind = OPTION_INTEGER,
         .value = &batch->jobs,
         .argument = "N",
         .min_integer = 1,
         .max_integer = BATCH_MAX_WORKERS,
         .help =
             "images to encode at a time on each device (default: on host as many as it has threads, else 2); one at a "
             "time where an image takes more than its share of the device's memory"},
        {.name = "skip-existing",
         .kind = OPTION_FLAG,
         .value = &batch->skip_existing,
         .help = "leave out images whose output exists: with it the same command goes on where a run was stopped or "
                 "killed"},
        {.name = "jsonl",
         .kind = OPTION_TEXT,
         .value = &batch->jsonl,
         .argument = "FILE",
         .help = "keep a report in FILE, a line of JSON for each image; - is standard output"},
        {.name = "shard",
         .kind = OPTION_SHARE,
         .value = &batch->shard,
         .argument = "I/N",
         .max_integer = MAX_SHARDS,
         .help = "encode only the Ith of N shares of the images, so that N runs encode each of them once"},
        {.name = "preset",
         .kind = OPTION_WORD,
         .value = &encode->preset,
         .given = &encode->has_preset,
         .words = preset_words,
         .argument = "NAME",
         .help =
             "target and effort by what the file is for: tiny, a placeholder (--bytes 250 --effort 3); preview (--bpp "
             "0.06, or 256 bytes if that is more, --effort 3); small, the defaults; good (-q 50); an --effort beside "
             "it counts"},
        {.name = "bytes",
         .kind = OPTION_INTEGER,
         .value = &encode->bytes,
         .given = &encode->has_bytes,
         .argument = "N",
         .min_integer = 1,
         .max_integer = GSCL_MAX_TARGET_BYTES,
         .help = "maximum size of the file"},
        {.name = "bpp",
         .kind = OPTION_REAL,
         .value = &encode->bpp,
         .given = &encode->has_bpp,
         .argument = "R",
         .min_real = 0.0001,
         .max_real = 64.0,
         .help = "maximum size of the file in bits per pixel (default 0.125, or 256 bytes if that is more)"},
        {.name = "psnr",
         .kind = OPTION_REAL,
         .value = &encode->psnr,
         .given = &encode->has_psnr,
         .argument = "DB",
         .min_real = 1.0,
         .max_real = 100.0,
         .help = "PSNR to reach in dB, exceeded by at most 0.3, or by what 2.5 % of the bytes bring"},
        {.name = "ssimulacra2",
         .kind = OPTION_REAL,
         .value = &encode->ssimulacra2,
         .given = &encode->has_ssimulacra2,
         .argument = "X",
         .min_real = GSCL_MIN_SSIMULACRA2,
         .max_real = 100.0,
         .help =
             "SSIMULACRA 2 to reach, what people see: 70 is good, 50 fair, 10 poor; mostly exceeded by less than 1, by "
             "at most 2, or by what 5 % of the bytes bring; for images from 8x8 pixels on"},
        {.name = "quality",
         .letter = 'q',
         .kind = OPTION_REAL,
         .value = &encode->quality,
         .given = &encode->has_quality,
         .argument = "Q",
         .min_real = 0,
         .max_real = 100,
         .help = "quality as of JPEG: a --ssimulacra2 of Q from 30 on, and down to -50 for 0; the best file where it "
                 "cannot be reached; 10, 30, 50, 70 and 90 take some 0.07, 0.26, 0.5, 1.2 and 7 bits per pixel for "
                 "photographs"},
        {.name = "splats",
         .kind = OPTION_INTEGER,
         .value = &encode->splats,
         .given = &encode->has_splats,
         .argument = "N",
         .min_integer = 1,
         .max_integer = GSCL_MAX_SPLATS,
         .help = "number of splats"},
        {.name = "effort",
         .kind = OPTION_INTEGER,
         .value = &encode->effort,
         .given = &encode->has_effort,
         .argument = "N",
         .min_integer = 0,
         .max_integer = GSCL_MAX_EFFORT,
         .help =
             "0 is fastest, 9 has the best quality (default 5); on two cores 2 megapixels take 1, 6 and 17 s at 0, 2 "
             "and 5, and 14 take 8, 98 and 127 s"},
        {.name = "profile",
         .kind = OPTION_WORD,
         .value = &encode->profile,
         .words = profile_words,
         .argument = "P",
         .help = "coding of the splats (default: default)"},
        {.name = "blend",
         .kind = OPTION_WORD,
         .value = &encode->blend,
         .words = blend_words,
         .argument = "B",
         .help = "blending of the splats of a pixel (default: auto, by the profile)"},
        {.name = "loss",
         .kind = OPTION_WORD,
         .value = &encode->loss,
         .words = loss_words,
         .argument = "L",
         .help = "loss that the fit minimises (default: auto, by the profile)"},
        {.name = "tune",
         .kind = OPTION_WORD,
         .value = &encode->tune,
         .words = tune_words,
         .argument = "T",
         .help = "quality measure to optimise: psnr, ssim for MS-SSIM, or visual for what people see (default: auto: "
                 "psnr for files below 600 bytes without -q and --ssimulacra2, with --psnr, and for images with "
                 "transparent parts or above 16 megapixels; else visual)"},
        {.name = "effects",
         .kind = OPTION_TEXT,
         .value = &encode->effects,
         .argument = "LIST",
         .help = "effects to switch on or off, as in +opacity,-chroma: chroma, alpha-channel, opacity, rotation, "
                 "anisotropy, texture (default: chosen for the image)"},
        {.name = "codebook",
         .kind = OPTION_INTEGER,
         .value = &encode->codebook,
         .given = &encode->has_codebook,
         .argument = "K",
         .min_integer = MIN_CODEBOOK,
         .max_integer = MAX_CODEBOOK,
         .help = "code words in each codebook of the paper profile (default: chosen by rate)"},
        {.name = "seed",
         .kind = OPTION_INTEGER,
         .value = &encode->seed,
         .argument = "S",
         .min_integer = 0,
         .max_integer = UINT64_MAX,
         .help = "seed of the random numbers; the same seed gives the same file (default 1)"},
        {.name = "progressive",
         .kind = OPTION_FLAG,
         .value = &batch->settings.progressive,
         .help = "write layers, so that the first part of the file draws a better picture (gscl decode --partial); the "
                 "whole picture loses 0.5 to 1 dB, and encoding takes two to three times as long"},
        {.name = "bare",
         .kind = OPTION_FLAG,
         .value = &batch->settings.bare,
         .help = "write the picture alone, 7 bytes less: without magic bytes, version and check; readers must be told"},
        {.name = "base64",
         .kind = OPTION_FLAG,
         .value = &batch->base64,
         .help =
             "write one line of base64url text (default output: standard output; in --out-dir: IN with suffix .b64)"},
        {.name = "packets",
         .kind = OPTION_INTEGER,
         .value = &encode->packet_size,
         .argument = "N",
         .min_integer = GSCL_MIN_PACKET_SIZE,
         .max_integer = GSCL_MAX_PACKET_SIZE,
         .help = "write packets of at most N bytes, 40 to 1400, each of which draws by itself (default output: IN with "
                 "the suffixes .000.gsclp, .001.gsclp and so on; with -o one file, a list; with --base64 a line each)"},
        {.name = "packet-count",
         .kind = OPTION_INTEGER,
         .value = &encode->packet_count,
         .argument = "K",
         .min_integer = 1,
         .max_integer = GSCL_MAX_PACKETS,
         .help = "write K packets of the size of --packets (default: as many as --bytes or --bpp needs)"},
        {.name = "packet-loss",
         .kind = OPTION_REAL,
         .value = &encode->batch.settings.packet_loss,
         .argument = "P",
         .min_real = 0,
         .max_real = 0.9,
         .help = "share of packets that are expected to be lost, 0 to 0.9: that many and more are made good by repair "
                 "packets, which take room (default 0)"},
        {.name = "packet-identity",
         .kind = OPTION_INTEGER,
         .value = &encode->packet_identity,
         .argument = "I",
         .min_integer = 1,
         .max_integer = 255,
         .help = "number of the picture in each packet, not 199 (default: one that follows from the picture)"},
        {.name = "keep-profile",
         .kind = OPTION_FLAG,
         .value = &batch->reading.keep_profile,
         .help = "store colours other than sRGB as they are, with their profile (default: convert them to sRGB)"},
        {.name = "metadata",
         .kind = OPTION_WORD,
         .value = &encode->metadata,
         .argument = "M",
         .words = metadata_words,
         .help = "metadata to store: EXIF, or all, which is EXIF and XMP (default none)"},
        DEVICE_OPTIONS_AS(batch->choice,
                          "device: its number P.D, part of its name, host, or all, which spreads the images over all "
                          "OpenCL devices, and over host where all of those are GPUs (default: see 'gscl devices')"),
        {.name = "json",
         .kind = OPTION_FLAG,
         .value = &batch->json,
         .help = "report on standard output as JSON; an array when there are several inputs"},
        {.name = "trace",
         .kind = OPTION_FLAG,
         .value = &batch->settings.trace,
         .help = "add the convergence trace to the JSON report: PSNR over time during the fit; takes a little longer"},
        {.name = "quiet", .kind = OPTION_FLAG, .value = &batch->quiet, .help = "print errors only"},
        {.name = "verbose",
         .letter = 'v',
         .kind = OPTION_FLAG,
         .value = &batch->choice.verbose,
         .help = "print on standard error what was turned, converted and dropped, and messages of the library"},
    };
    const option_command command = {
        .name = "encode",
        .usage =
            "IN... [--files-from FILE] [[-o] OUT.gscl | --out-dir DIR] [--preset NAME | -q Q | --bytes N | --bpp R | "
            "--psnr DB | --ssimulacra2 X | --splats N] [options]",
        .about = "Encodes images as gscl files.  Reads PNG, JPEG, WebP, AVIF, HEIC, JPEG 2000, GIF, TIFF, OpenEXR, "
                 "HDR, BMP, ICO,\n"
                 "TGA, PNM, PSD, SGI and DDS, grey or RGB, with or without alpha.  IN may be -, standard input.  "
                 "Images are\n"
                 "turned upright by their EXIF, and colours are converted to sRGB, CMYK with a profile "
                 "included.\n\n" ABOUT_RUNS,
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 0, /* with --files-from; else see check_run */
        .max_operands = argc,
    };
    int first = 0;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    batch->inputs = argv + first;
    batch->count = argc - first;
    return outcome;
}

static bool reads_standard_input(const encode_batch *batch) {
    for (int i = 0; i < batch->count; i++) {
        if (strcmp(batch->inputs[i], "-") == 0)
            return true;
    }
    return false;
}

/* Refuses options of runs over many images that contradict others.  Returns 0 or EXIT_USAGE. */
static int check_run(const encode_batch *batch) {
    const bool is_run = encode_batch_is_run(batch);
    if (batch->count == 0 && !batch->files_from)
        return report_usage(
            "encode", "an input is missing; usage: gscl encode IN... [options], or a list of images with --files-from");
    if (batch->null && !batch->files_from)
        return report_usage("encode", "--null is about a list of images; add --files-from");
    if (batch->keep_tree && !batch->out_dir)
        return report_usage("encode", "--keep-tree makes folders in --out-dir; add it");
    if (batch->files_from && batch->output)
        return report_usage("encode", "-o names one file but --files-from lists many images; use --out-dir");
    if (batch->files_from && strcmp(batch->files_from, "-") == 0 && reads_standard_input(batch))
        return report_usage("encode", "the list and an image both come from standard input; put one into a file");
    if (is_run && encode_batch_is_piped(batch))
        return report_usage("encode",
                            "--files-from, --jsonl, --skip-existing and --shard need output files; add --out-dir");
    if (is_run && batch->json)
        return report_usage("encode",
                            "--json holds no results of --files-from, --jsonl, --skip-existing and --shard; use "
                            "--jsonl FILE");
    return 0;
}

/* Refuses options that contradict each other.  Returns 0 or EXIT_USAGE. */
static int check_options(encode_options *encode) {
    const encode_batch *batch = &encode->batch;
    if (!effect_list_parse(encode->effects, &encode->effects_on, &encode->effects_off))
        return EXIT_USAGE;
    if (encode->has_preset + encode->has_bytes + encode->has_bpp + encode->has_psnr + encode->has_ssimulacra2 +
            encode->has_quality + encode->has_splats >
        1)
        return report_usage(
            "encode", "--preset, --bytes, --bpp, --psnr, --ssimulacra2, --quality and --splats exclude each other; "
                      "give one of them");
    if (encode->has_codebook && encode->profile != GSCL_PROFILE_PAPER)
        return report_usage("encode", "--codebook applies to the paper profile only; add --profile paper");
    if (batch->output && batch->out_dir)
        return report_usage("encode", "-o and --out-dir exclude each other; give one of them");
    if (batch->output && batch->count > 1)
        return report_usage("encode", "-o names one file but there are %d inputs; use --out-dir", batch->count);
    if (!batch->output && !batch->base64 && reads_standard_input(batch))
        return report_usage("encode", "the output's name is missing; with standard input, give -o");
    if (batch->settings.bare && (batch->reading.keep_profile || encode->metadata != METADATA_NONE))
        return report_usage("encode", "a bare file has no room for --keep-profile and --metadata; leave out --bare");
    if (batch->quiet && batch->choice.verbose)
        return report_usage("encode", "--quiet and -v exclude each other; give one of them");
    if (batch->settings.trace && !batch->json)
        return report_usage("encode", "--trace is part of the JSON report; add --json");
    if (batch->json && batch->output && encode_batch_is_piped(batch))
        return report_usage("encode", "--json and -o - both write to standard output; name a file with -o");
    if (batch->json && batch->base64 && !batch->output && !batch->out_dir)
        return report_usage("encode", "--json and --base64 both write to standard output; name a file with -o");
    return check_run(batch);
}

/* Of the options that exclude each other, of which at most one is given. */
static void fill_target(encode_options *encode) {
    gscl_encode_settings *settings = &encode->batch.settings;
    if (encode->has_bytes) {
        settings->target = GSCL_TARGET_BYTES;
        settings->target_value = (double)encode->bytes;
    } else if (encode->has_bpp) {
        settings->target = GSCL_TARGET_BPP;
        settings->target_value = encode->bpp;
    } else if (encode->has_psnr) {
        settings->target = GSCL_TARGET_PSNR;
        settings->target_value = encode->psnr;
    } else if (encode->has_ssimulacra2) {
        settings->target = GSCL_TARGET_SSIMULACRA2;
        settings->target_value = encode->ssimulacra2;
    } else if (encode->has_quality) {
        settings->target = GSCL_TARGET_QUALITY;
        settings->target_value = encode->quality;
    } else if (encode->has_splats) {
        settings->target = GSCL_TARGET_SPLATS;
        settings->target_value = (double)encode->splats;
    }
}

/* Returns false, after a message, where the library that is loaded does not have the preset. */
static bool fill_settings(encode_options *encode) {
    encode->batch.choice.quiet = encode->batch.quiet;
    gscl_encode_settings *settings = &encode->batch.settings;
    if (encode->has_preset && gscl_encode_settings_preset(settings, (gscl_preset)encode->preset) != GSCL_OK)
        return report_error("encode", "libgscl has no preset '%s'", preset_words[encode->preset]);
    fill_target(encode);
    settings->profile = (gscl_profile)encode->profile;
    settings->blend = (gscl_blend)encode->blend;
    settings->loss = (gscl_loss)encode->loss;
    settings->tune = (gscl_tune)encode->tune;
    if (encode->has_effort)
        settings->effort = (int)encode->effort;
    settings->effects_on = encode->effects_on;
    settings->effects_off = encode->effects_off;
    settings->codebook_size = (uint32_t)encode->codebook;
    settings->seed = encode->seed;
    settings->packet_size = (uint32_t)encode->packet_size;
    settings->packet_count = (uint32_t)encode->packet_count;
    settings->packet_identity = (uint32_t)encode->packet_identity;
    encode->batch.reading.keep_exif = encode->metadata != METADATA_NONE;
    encode->batch.reading.keep_xmp = encode->metadata == METADATA_ALL;
    return true;
}

int command_encode(int argc, char **argv) {
    encode_options encode = {.seed = 1};
    gscl_encode_settings_default(&encode.batch.settings);
    const option_outcome outcome = parse_encode(&encode, argc, argv);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    encode_batch *batch = &encode.batch;
    if (take_output_operand(batch) != EXIT_SUCCESS)
        return EXIT_USAGE;
    if (check_options(&encode) != 0)
        return EXIT_USAGE;
    if (!fill_settings(&encode))
        return EXIT_FAILURE;
    return encode_batch_run(&encode.batch);
}
