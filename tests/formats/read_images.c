/* Reads image files as the tool does, many in one process: read_images < NAMES > PIXELS
 *
 * NAMES are file names, one a line.  For each, PIXELS has a line "WIDTH HEIGHT CHANNELS SAMPLE PREMULTIPLIED" (SAMPLE is u1,
 * u2 or f4, in the byte order of this machine) and the samples, or a line "error TEXT". */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/message.h"
#include "image/image_file.h"

static const char *sample_name(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8 ? "u1" : sample == GSCL_SAMPLE_U16 ? "u2" : "f4";
}

static void put_image(const gscl_image *image) {
    const char *sample = sample_name(image->sample);
    const size_t samples = (size_t)image->width * image->height * image->channels;
    printf("%u %u %u %s %d\n", image->width, image->height, image->channels, sample, image->premultiplied);
    fwrite(image->pixels, (size_t)(sample[1] - '0'), samples, stdout);
}

int main(void) {
    char name[4096];
    while (fgets(name, sizeof name, stdin)) {
        char text[1024] = "";
        gscl_image image;
        name[strcspn(name, "\n")] = '\0';
        message_keep_errors(text, sizeof text);
        if (image_read(name, &image)) {
            put_image(&image);
            free(image.pixels);
        } else {
            printf("error %s\n", text);
        }
        fflush(stdout);
    }
    return 0;
}
