/* The search for the smallest file that reaches a PSNR: which sizes to try.  It encodes nothing itself. */
#ifndef GSCL_LIB_PSNR_SEARCH_H
#define GSCL_LIB_PSNR_SEARCH_H

#include <stdbool.h>

typedef struct gscl_psnr_search {
    double target;              /* dB */
    double max_bytes;           /* of the largest file that is tried */
    double bytes;               /* to be tried next */
    int trials;                 /* so far */
    bool done;                  /* no further trial is of use */
    double low_bytes, low_db;   /* the largest size known to be too poor; 0 without one */
    double high_bytes, high_db; /* the smallest size known to be good enough; 0 without one */
} gscl_psnr_search;

/* `pixels`: of the image. */
gscl_psnr_search gscl_psnr_search_begin(double target, double pixels);
/* Takes the PSNR of a file of search->bytes.  Returns whether it reaches the target: then it is the best so far. */
bool gscl_psnr_search_add(gscl_psnr_search *search, double psnr);

#endif
