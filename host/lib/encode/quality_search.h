/* The search for the smallest file that reaches a quality: which sizes to try.  It encodes nothing itself.
 *
 * It begins with probes, encodes at effort 0, which take a tenth of the time.  From their qualities follow those of complete
 * encodes of the same sizes, in the mean, and so a first size and the slope of quality for the trials, complete encodes. */
#ifndef GSCL_LIB_QUALITY_SEARCH_H
#define GSCL_LIB_QUALITY_SEARCH_H

#include <stdbool.h>

#include "encode/tunables.h"

/* A file of one of the sizes that were tried. */
typedef struct gscl_quality_point {
    double bytes;   /* 0: there is none */
    double quality; /* in the unit of the measure */
    double scale;   /* the same on the scale of the measure; of a probe: as it predicts it of a complete encode */
} gscl_quality_point;

typedef struct gscl_quality_search {
    const gscl_quality_tunables *tunables;
    double pixels;                /* of the image */
    double target;                /* in the unit of the measure */
    double max_bytes;             /* of the largest file that is tried */
    double bytes;                 /* to be tried next */
    bool is_probe;                /* the next file is a probe */
    int probes, trials;           /* so far */
    bool done;                    /* no further trial is of use */
    double slope;                 /* of the measure's scale when the bytes double, as far as it is known */
    gscl_quality_point probe;     /* the last one */
    bool was_reached;             /* the target, by the last trial */
    int repeats;                  /* how many trials before the last one had the same outcome */
    gscl_quality_point low, high; /* the largest size known to be too poor, and the smallest known to be good enough */
    double best_quality;          /* of all trials */
} gscl_quality_search;

/* `pixels`: of the image.  `has_probes`: without them the first trial has the size that an image needs in the mean. */
gscl_quality_search gscl_quality_search_begin(const gscl_quality_tunables *tunables, double target, double pixels,
                                              bool has_probes);
/* Takes the quality of a file that was encoded for search->bytes and has `size` bytes: fewer where the image has no use for more.
 * Returns whether it is a trial that reaches the target: then it is the best so far. */
bool gscl_quality_search_add(gscl_quality_search *search, double quality, double size);

#endif
