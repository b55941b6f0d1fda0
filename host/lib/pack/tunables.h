/* Numbers of pack/ that were found by trying. */
#ifndef GSCL_LIB_PACK_TUNABLES_H
#define GSCL_LIB_PACK_TUNABLES_H

struct gscl_pack_tunables {
    double rounding;      /* relative, or of the range of colours; changes of a splat up to it count as rounding */
    double same_place;    /* pixels; centres as near to those of their codes are the same: files have units of 1/512 */
    double least_weight;  /* of the largest weight; smaller ones count as changed: half of the smallest weight that the
                            finest steps have */
    double finest_factor; /* of the default steps: those after the finest of all */
    double coarsest_factor; /* of the default steps */
    int steps_per_octave;   /* from one set of steps to the next coarser one */
    /* Of the target: bytes that the codes take before passes choose others.  For bytes both are tried, for a PSNR, which is near
     * that of the field, the first one.  On fields of 2000 and 10000 splats of two photographs 1.0 is the best where nearly
     * nothing is lost, 1.1 at 33 to 40 bits a splat, by up to 0.3 dB; 0.95 and 1.2 are worse than both. */
    double surpluses[2];
    double first_share; /* of the bytes without passes: the first file with passes for a PSNR */
    double
        unreached_share; /* of the bytes of the finest steps: where these do not reach a PSNR, the most that passes get */
    int max_trials;      /* files with passes for a PSNR */
    double psnr_excess; /* dB above the target that is accepted */
};

extern const struct gscl_pack_tunables gscl_pack_tunables;

#endif
