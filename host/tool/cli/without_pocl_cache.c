/* In place of pocl_cache.c on Windows, for which there is no package of PoCL. */
#include "cli/pocl_cache.h"

bool pocl_cache_exists(void) {
    return false;
}

void pocl_cache_prepare(bool quiet) {
    (void)quiet;
}

bool pocl_cache_explain(char *text, size_t size) {
    (void)text, (void)size;
    return false;
}
