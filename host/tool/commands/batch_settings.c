#include "commands/batch_settings.h"

#include <unistd.h>

#include "host/system/output_target.h"

bool encode_batch_is_run(const encode_batch *batch) {
    return batch->files_from || batch->jsonl || batch->skip_existing || batch->shard.count > 0;
}

bool encode_batch_has_packet_files(const encode_batch *batch) {
    return batch->settings.packet_size > 0 && !batch->output && !batch->base64;
}

bool encode_batch_is_piped(const encode_batch *batch) {
    return batch->output ? output_descriptor(batch->output) == STDOUT_FILENO : batch->base64 && !batch->out_dir;
}
