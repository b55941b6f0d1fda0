#include "cli/names.h"

#include <stddef.h>

const char *const preset_words[] = {"tiny", "preview", "small", "good", NULL};
const char *const profile_words[] = {"default", "paper", NULL};
const char *const blend_words[] = {"auto", "normalized", "alpha", "sum", NULL};
const char *const loss_words[] = {"auto", "l1", "l1+ssim", "l2", NULL};
const char *const tune_words[] = {"auto", "psnr", "ssim", "visual", NULL};
const char *const mapping_words[] = {"auto", "cpu", "gpu", NULL};

const char *channels_name(unsigned channels) {
    static const char *const names[] = {"no", "grey", "grey+alpha", "RGB", "RGBA"};
    return names[channels < sizeof names / sizeof *names ? channels : 0];
}
