/* For LD_PRELOAD: a libpng that crashes on images that are 13 pixels wide. */
#define _GNU_SOURCE /* RTLD_NEXT */
#include <dlfcn.h>
#include <signal.h>

#include <png.h>

void png_read_info(png_structrp png, png_inforp info) {
    void (*original)(png_structrp, png_inforp);
    *(void **)&original = dlsym(RTLD_NEXT, "png_read_info");
    original(png, info);
    while (png_get_image_width(png, info) == 13) /* as a fault would, where a handler returns */
        raise(SIGSEGV);
}
