#include "image/image_content.h"

#include <stdlib.h>
#include <string.h>

bool image_blob_append(image_blob *blob, const void *bytes, size_t size) {
    if (size == 0)
        return true;
    if (size > IMAGE_MAX_BLOB - blob->size)
        return false;
    uint8_t *grown = realloc(blob->bytes, blob->size + size);
    if (!grown)
        return false;
    memcpy(grown + blob->size, bytes, size);
    blob->bytes = grown;
    blob->size += size;
    return true;
}

bool image_blob_set(image_blob *blob, const void *bytes, size_t size) {
    image_blob_free(blob);
    return image_blob_append(blob, bytes, size);
}

void image_blob_free(image_blob *blob) {
    free(blob->bytes);
    *blob = (image_blob){0};
}

void image_metadata_free(image_metadata *metadata) {
    image_blob_free(&metadata->icc);
    image_blob_free(&metadata->exif);
    image_blob_free(&metadata->xmp);
    *metadata = (image_metadata){0};
}

void image_content_free(image_content *content) {
    free(content->image.pixels);
    image_metadata_free(&content->metadata);
    *content = (image_content){0};
}
