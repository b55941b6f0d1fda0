/* Decodes files by rows on a board: decode_file STRIP_ROWS IN OUT
 *
 * Writes the samples of all rows to OUT, and prints numbers of bytes and of instructions, each on a line with its name before it.
 * STRIP_ROWS is 0 to 9999.  The decoder gets its least memory. */
#include <gscl/gscl.h>

#include "board.h"
#include "decode/coded_image.h"
#include "decode/format_result.h"

#define MAX_FILE 4096u /* bytes */

static uint8_t file[MAX_FILE];

static uint32_t number_of(const char *digits) {
    uint32_t number = 0;
    for (; *digits >= '0' && *digits <= '9'; digits++)
        number = 10 * number + (uint32_t)(*digits - '0');
    return number;
}

static bool write_strip(void *opaque, uint32_t y, const gscl_image *strip) {
    (void)y;
    board_write(*(const int *)opaque, strip->pixels, (size_t)strip->width * strip->height * strip->channels);
    return true;
}

static void require(gscl_result result) {
    if (result == GSCL_OK)
        return;
    board_print_number("result", (uint32_t)result);
    board_exit(false);
}

/* Prints the instructions of reading alone. */
static void measure_reading(const uint8_t *bytes, size_t size, uint8_t *memory) {
    gsf_coded_image coded = {.bare = false};
    require(gscl_result_of_format(gsf_read_header(bytes, size, false, &coded.header)));
    coded.splats = (gsf_splat *)memory;
    board_start_count();
    require(gscl_result_of_format(gsf_read(bytes, size, &coded, coded.splats + coded.header.splat_count)));
    board_print_number("reading", board_count());
    board_print_number("splats", coded.header.splat_count);
}

int main(void) {
    const char *words[4];
    size_t free_size, needed;
    gscl_image image;
    uint8_t *memory = board_free_memory(&free_size);
    if (board_words(words, 4) != 4)
        return 1;
    const uint32_t strip_rows = number_of(words[1]);
    const size_t size = board_read(words[2], file, sizeof file);
    int out = board_create(words[3]);
    require(gscl_rows_memory(file, size, NULL, strip_rows, &image, &needed));
    if (needed > free_size)
        require(GSCL_ERROR_OUT_OF_MEMORY);
    board_start_count();
    require(gscl_decode_rows(file, size, NULL, strip_rows, memory, needed, write_strip, &out));
    board_print_number("instructions", board_count());

    board_print_number("memory", (uint32_t)needed);
    board_print_number("stack", (uint32_t)board_used_stack());
    board_print_number("variables", (uint32_t)(board_variables() - sizeof file));
    board_print_number("file", (uint32_t)size);
    measure_reading(file, size, memory);
    return 0;
}
