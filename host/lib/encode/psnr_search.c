#include "encode/psnr_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "encode/profile.h"

#define MAX_TRIALS 12
#define TOLERANCE_DB 0.3    /* above the target */
#define DB_PER_DOUBLING 2.5 /* first guess of how PSNR grows with the rate */
#define FIRST_BPP 0.1

/* Sizes tried so far around the target. */
typedef struct bracket {
    double low_bytes, low_db;   /* the largest size known to be too poor */
    double high_bytes, high_db; /* the smallest size known to be good enough; 0 while none is */
} bracket;

/* The size at which a line through the bracket (PSNR against log size) meets the middle of the target band. */
static double next_size(const bracket *b, double target, double largest) {
    double aim = target + TOLERANCE_DB / 3, bytes;
    if (b->low_bytes > 0 && b->high_bytes > 0) {
        double t = (aim - b->low_db) / (b->high_db - b->low_db);
        t = fmin(fmax(t, 0.1), 0.9);
        bytes = b->low_bytes * pow(b->high_bytes / b->low_bytes, t);
    } else if (b->low_bytes > 0) {
        bytes = b->low_bytes * fmin(pow(2, (aim - b->low_db) / DB_PER_DOUBLING + 0.1), 8);
    } else {
        bytes = b->high_bytes * fmax(pow(2, (aim - b->high_db) / DB_PER_DOUBLING - 0.1), 0.1);
    }
    return fmin(bytes, largest);
}

/* Fits at this size and measures what its decoder gives. */
static gscl_result try_size(gscl_encoder *e, double bytes, double *psnr) {
    e->random = e->settings.seed; /* a trial does not depend on those before */
    e->trials++;
    GSCL_TRY(gscl_encode_profile(e, (size_t)bytes, 0));
    return gscl_encoder_psnr(e, psnr);
}

/* Keeps a copy of the encoder's picture as bytes. */
static gscl_result keep(gscl_encoder *e, uint8_t **bytes, size_t *size) {
    free(*bytes);
    *bytes = NULL;
    return gscl_coded_image_write(&e->coded, bytes, size);
}

static gscl_result search(gscl_encoder *e, uint8_t **best, size_t *best_size) {
    double target = e->settings.target_value, pixels = (double)e->image->width * e->image->height;
    double largest = fmax(pixels * 4, 4096), size = fmax(FIRST_BPP * pixels / 8, 64);
    bracket b = {0};
    for (int trial = 0; trial < MAX_TRIALS; trial++) {
        double psnr;
        gscl_progress_stage(&e->progress, (double)trial / MAX_TRIALS, (trial + 1.0) / MAX_TRIALS);
        GSCL_TRY(try_size(e, size, &psnr));
        gscl_log(e->context, GSCL_LOG_INFO, "trial %d: %.0f bytes, %.3f dB", trial + 1, size, psnr);
        if (psnr >= target) {
            GSCL_TRY(keep(e, best, best_size));
            b.high_bytes = size;
            b.high_db = psnr;
            if (psnr <= target + TOLERANCE_DB)
                return GSCL_OK;
        } else {
            b.low_bytes = size;
            b.low_db = psnr;
            if (size >= largest)
                break;
        }
        if (b.high_bytes > 0 && b.high_bytes - b.low_bytes < 4)
            return GSCL_OK; /* nothing in between */
        size = floor(next_size(&b, target, largest));
    }
    if (*best)
        return GSCL_OK;
    return gscl_fail(e->context, GSCL_ERROR_TARGET_UNREACHABLE, "%.2f dB cannot be reached; the best found is %.2f dB",
                     target, b.low_db);
}

gscl_result gscl_encode_to_psnr(gscl_encoder *e) {
    uint8_t *best = NULL;
    size_t size = 0;
    gscl_result result = search(e, &best, &size);
    if (result == GSCL_OK) {
        gscl_coded_image_free(&e->coded);
        result = gscl_coded_image_read(&e->coded, best, size);
    }
    free(best);
    return result;
}
