#include "scalar/kept_codes.h"

#include <stdlib.h>
#include <string.h>

void gscl_kept_codes_free(gscl_kept_codes *kept) {
    free(kept->splats);
    *kept = (gscl_kept_codes){0};
}

gscl_result gscl_kept_codes_keep(gscl_kept_codes *kept, const gscl_scalar_state *s, double error) {
    const gsf_coded_image *file = &s->coded->file;
    const size_t count = file->header.splat_count;
    if (count > kept->capacity) {
        gsf_splat *grown = realloc(kept->splats, count * sizeof *grown);
        if (!grown)
            return gscl_fail_memory(s->encoder->context);
        kept->splats = grown;
        kept->capacity = count;
    }
    if (count > 0)
        memcpy(kept->splats, file->splats, count * sizeof *kept->splats);
    kept->count = (uint32_t)count;
    kept->has_texture = file->header.has_texture;
    kept->size = s->size;
    kept->error = error;
    return GSCL_OK;
}

gscl_result gscl_kept_codes_keep_better(gscl_kept_codes *kept, const gscl_scalar_state *s, double error) {
    return kept->count == 0 || error < kept->error ? gscl_kept_codes_keep(kept, s, error) : GSCL_OK;
}

gscl_result gscl_kept_codes_restore(const gscl_kept_codes *kept, gscl_scalar_state *s) {
    gsf_coded_image *file = &s->coded->file;
    file->header.splat_count = kept->count;
    GSCL_TRY(gscl_coded_image_reserve(s->coded, kept->count));
    if (kept->count > 0)
        memcpy(file->splats, kept->splats, kept->count * sizeof *kept->splats);
    file->header.has_texture = kept->has_texture;
    s->size = kept->size;
    return GSCL_OK;
}
