/* The public functions that decode by rows.  Nothing here or below allocates. */
#include "cl/constants.h"
#include "decode/draw_rows.h"
#include "decode/format_result.h"
#include "format/format.h"
#include "runtime/context.h"
#include "runtime/struct_size.h"

/* Where the parts of the memory begin: the codes of the file, and behind them what reading and drawing use in turn. */
typedef struct rows_plan {
    gscl_decode_settings settings;
    gsf_header header;
    gscl_rows rows;
    uint64_t codes;   /* bytes, a multiple of ALIGNMENT */
    uint64_t working; /* bytes, the least */
} rows_plan;

#define ALIGNMENT 8u /* bytes, enough for all types here */

static uint64_t codes_size(const gsf_header *header) {
    const size_t words = GSF_MAX_CODEBOOK * (GSF_SHAPE_DIMS + GSF_MAX_COLOUR_DIMS) * sizeof(uint16_t);
    const uint64_t splats = header->splat_count;
    const uint64_t size =
        header->coding == GSF_CODING_SCALAR ? splats * sizeof(gsf_splat) : splats * sizeof(gsf_indexed_splat) + words;
    return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Places the arrays of a coded image in memory of codes_size. */
static void place_codes(gsf_coded_image *coded, const gsf_header *header, void *memory) {
    gsf_codebooks *books = &coded->codebooks;
    coded->splats = memory;
    if (header->coding == GSF_CODING_SCALAR)
        return;
    coded->indexed = memory;
    books->shape_words = (uint16_t(*)[GSF_SHAPE_DIMS])(coded->indexed + header->splat_count);
    books->colour_words = (uint16_t(*)[GSF_MAX_COLOUR_DIMS])(books->shape_words + GSF_MAX_CODEBOOK);
}

static gscl_result read_settings(const gscl_decode_settings *caller, gscl_decode_settings *s) {
    *s = (gscl_decode_settings){.struct_size = sizeof *s};
    if (caller && !GSCL_STRUCT_FITS(gscl_decode_settings, max_pixels, caller))
        return GSCL_ERROR_STRUCT_SIZE;
    if (caller)
        gscl_struct_copy(caller, s, sizeof *s);
    return gscl_output_is_possible(s) ? GSCL_OK : GSCL_ERROR_INVALID_ARGUMENT;
}

static gscl_result plan_rows(const uint8_t *bytes, size_t size, const gscl_decode_settings *settings,
                             uint32_t strip_rows, rows_plan *plan) {
    GSCL_TRY(read_settings(settings, &plan->settings));
    GSCL_TRY(gscl_result_of_format(gsf_read_header(bytes, size, plan->settings.bare, &plan->header)));
    GSCL_TRY(gscl_frame_resolve(&plan->settings, &plan->header, &plan->rows.frame));
    plan->rows.output = gscl_output_of(&plan->rows.frame, &plan->settings, &plan->header);
    plan->rows.strip_rows = strip_rows;
    const uint64_t reading = gsf_read_scratch_size(&plan->header);
    const uint64_t drawing = gscl_draw_rows_memory(&plan->header, &plan->rows);
    plan->codes = codes_size(&plan->header);
    plan->working = reading > drawing ? reading : drawing;
    return GSCL_OK;
}

/* The memory may begin at any address. */
static uint64_t least_memory(const rows_plan *plan) {
    return ALIGNMENT - 1 + plan->codes + plan->working;
}

gscl_result gscl_rows_memory(const uint8_t *bytes, size_t size, const gscl_decode_settings *settings,
                             uint32_t strip_rows, gscl_image *image, size_t *memory_size) {
    rows_plan plan;
    if (!bytes || !memory_size)
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(plan_rows(bytes, size, settings, strip_rows, &plan));
    const uint64_t least = least_memory(&plan);
    if (least > SIZE_MAX)
        return GSCL_ERROR_OUT_OF_MEMORY;
    *memory_size = (size_t)least;
    if (image)
        *image = plan.rows.output.image;
    return GSCL_OK;
}

/* Reads the file into `coded`, whose arrays are in place, and checks the work. */
static gscl_result read_codes(const uint8_t *bytes, size_t size, const rows_plan *plan, gsf_coded_image *coded,
                              void *scratch) {
    uint32_t total;
    coded->bare = plan->settings.bare;
    const gsf_result result = plan->settings.partial ? gsf_read_prefix(bytes, size, coded, &total, scratch)
                                                     : gsf_read(bytes, size, coded, scratch);
    GSCL_TRY(gscl_result_of_format(result));
    return gscl_frame_excess_work(&plan->settings, coded, &plan->rows.frame) > 0 ? GSCL_ERROR_LIMIT : GSCL_OK;
}

gscl_result gscl_decode_rows(const uint8_t *bytes, size_t size, const gscl_decode_settings *settings,
                             uint32_t strip_rows, void *memory, size_t memory_size, gscl_rows_callback callback,
                             void *opaque) {
    rows_plan plan;
    gsf_coded_image coded = {.bare = false};
    if (!bytes || !memory || !callback)
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(plan_rows(bytes, size, settings, strip_rows, &plan));
    if (least_memory(&plan) > memory_size)
        return GSCL_ERROR_OUT_OF_MEMORY;
    const size_t skipped = (size_t)(-(uintptr_t)memory % ALIGNMENT), codes = (size_t)plan.codes;
    unsigned char *start = (unsigned char *)memory + skipped, *working = start + codes;
    place_codes(&coded, &plan.header, start);
    GSCL_TRY(read_codes(bytes, size, &plan, &coded, working));
    plan.rows.callback = callback;
    plan.rows.opaque = opaque;
    return gscl_draw_rows(&coded, &plan.rows, working, memory_size - skipped - codes);
}
