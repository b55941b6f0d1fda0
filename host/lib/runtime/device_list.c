#include "runtime/device_list.h"

#include <stdlib.h>

gscl_listed_device *gscl_device_list_grow(gscl_device_list *list, size_t more) {
    gscl_listed_device *grown = realloc(list->devices, (list->count + more) * sizeof *grown);
    if (!grown)
        return NULL;
    list->devices = grown;
    return grown + list->count;
}

void gscl_device_list_free(gscl_device_list *list) {
    free(list->devices);
    *list = (gscl_device_list){0};
}
