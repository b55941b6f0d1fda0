#include "format/picture.h"

#include "format/header.h"
#include "format/payload.h"

bool gsf_picture_is_at_end(const gsf_coder *coder) {
    return coder->decoder.position == coder->decoder.size + GSF_IMPLIED_BYTES;
}

gsf_result gsf_read_picture(gsf_coded_image *image, gsf_bytes picture, void *scratch) {
    gsf_coder coder;
    gsf_coder_read_from(&coder, picture.data, picture.size, image->stream_bits256);
    gsf_code_header(&coder, image);
    const bool valid =
        !gsf_coder_overrun(&coder) && gsf_code_payload(&coder, image, gsf_workspace_in(&image->header, scratch));
    if (gsf_coder_overrun(&coder))
        return GSF_TRUNCATED;
    return valid && gsf_picture_is_at_end(&coder) ? GSF_OK : GSF_CORRUPT;
}

gsf_result gsf_write_picture(gsf_coded_image *image, uint8_t *bytes, size_t capacity, size_t *size, void *scratch) {
    gsf_coder coder;
    gsf_coder_write_to(&coder, bytes, capacity, capacity > 0 ? image->stream_bits256 : NULL);
    gsf_code_header(&coder, image);
    if (!gsf_code_payload(&coder, image, gsf_workspace_in(&image->header, scratch)))
        return GSF_INVALID;
    gsf_range_encoder_finish(&coder.encoder);
    *size = coder.encoder.size;
    return *size <= capacity ? GSF_OK : GSF_NO_SPACE;
}
