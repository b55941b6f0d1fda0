/* Numbers of the fit that were found by trying.  Those of hot kernels are in cl/constants.h. */
#ifndef GSCL_LIB_FIT_TUNABLES_H
#define GSCL_LIB_FIT_TUNABLES_H

struct gscl_fit_tunables {
    /* Smallest allowed shorter side of a level of the pyramid: pixels. */
    int min_level_side;

    /* Bounds of a splat's shape: the shortest axis (sigma, full-size pixels) and the largest ratio of two axes. */
    float min_axis;
    float max_aspect;

    /* Steps for which the lists of the tiles stay as they are.  2, 4 and 8 change the mean PSNR of the Kodak set by less
     * than 0.03 dB, up or down; 4 and 8 save 5 to 7 % of an encode's time. */
    int bin_interval;
    int gpu_bin_interval; /* in the GPU mapping, where filling the lists takes launches that depend on each other; at most
                             check_interval, whose measurements it would delay */
    /* The same while steps follow a model of the visual loss.  The lists decide how long steps see the same half of the rows:
     * 8 steps cost 0.8 points of SSIMULACRA 2 at 0.183 bits a pixel against 4 (four pictures of the Kodak set, three seeds). */
    int gpu_model_bin_interval;
    /* Steps from one measurement of their lengths, on the device, to the next. */
    int check_interval;
    /* Steps after which the host waits for the device, to enlarge lists that have grown: at most, and pixels drawn meanwhile
     * (with at least check_interval steps), so that progress is reported and an encode can be cancelled in time.  On the
     * Kodak set 128 and 256 steps are as good (25.53 and 25.56 dB at 2064 bytes, 29.12 and 29.10 at 8994); with 128 an
     * encode waits 5 times more often, with 8 60 to 110 times.  The first wait is after check_interval steps, and so is that
     * after lists that were too short; each of the others after wait_growth times the steps of the one before.  The fits
     * of an encode at 0.042 bits a pixel wait 87 times with 2 (and models_to_check 4), 34 times with 8 (and 16). */
    int max_wait_interval;
    int wait_growth;
    double wait_pixels;
    /* New splats, as a part of those whose lists the host knows, with which it waits for the lists of all: an encode
     * adds three times those that it begins with.  0.1 measures the same and waits more often. */
    double max_new_splats;
    /* Mean number of splats a non-flat tile may have at the first level, at smaller levels (which have fewer tiles),
     * and at any level with alpha blending (where splats hide each other and need to be many).  Above it the bound on
     * the longest axis is reduced, because the time of a step grows with the number of splats a tile. */
    double max_occupancy;
    double max_occupancy_of_smaller_levels;
    double max_occupancy_of_alpha;
    /* Added to the bound, for each splat per tile: the number of tiles that a splat of the size of a tile touches. */
    double tiles_of_small_splat;
    /* Step in ln sigma by which the bound on the longest axis is reduced. */
    float axis_reduction;

    /* Tiles or splats: where groups are wide and there are more, many work-groups sum parts of what the control needs before
     * a single one does the rest.  At the limit that takes 64 additions of each work-item, about as long as a launch. */
    int gpu_summed_at_once;

    /* A splat whose standard deviation across the rows is smaller counts as low: rows of the level. */
    float low_axis;

    /* A tile whose loss per pixel is below this part of the mean loss of the non-flat tiles is skipped for
     * GSCL_SKIP_STEPS steps. */
    double skip_threshold;
    /* Lower bound of the share of non-flat tiles, however large the flat background is. */
    double min_non_flat_tiles;

    /* Placement of splats (fit/placement.h).  dB are means of 24 photographs at 0.042 and 0.183 bits a pixel. */
    /* Initial axes of the first splats, and of splats that are added later: sigma in mean distances between splats.  The
     * latter 0.22 to 0.45: up to 0.04 dB less. */
    float seed_axis;
    float new_axis;
    /* Largest factor by which new splats are larger where few are added: the distance between them beside its mean.  1
     * costs 0.02 dB.  Smaller splats where many are added cost 0.04 dB at 0.042 bits, and 3 dB on stars in the dark. */
    float max_spread;
    /* Along an edge the longer axis of a new splat grows, and the shorter one shrinks, by this in ln sigma.  0.5 to 0.8
     * are as good, 0 costs 0.02 and 0.1 dB. */
    float edge_stretch;
    /* Largest radius of the window in which the direction of an edge is found, which is sigma: pixels of the level.
     * Twice the window is as good. */
    int max_edge_radius;
    /* Sum of squared differences (samples 0 to 1) below which an edge counts in part: bounds the stretch in noise. */
    float min_edge;
    /* Initial opacity of splats that are added later: logit.  They start semi-transparent so as not to cover good
     * splats. */
    float new_opacity;
    /* Radius of the box sum over the squared error, where splats are added: mean distances between splats. */
    float error_radius;
    /* Distance from an edge beyond which a flat background gets no first splats: mean distances between splats. */
    float background_distance;
    /* Lower bound of the share of non-flat pixels, however large the flat background is. */
    float min_non_flat_pixels;

    /* Part of the tiles, those with the largest residual, that the residual of a level disregards: small objects count,
     * single specks do not. */
    double residual_outliers;

    /* The visual loss (fit/visual_loss.h); points are those of SSIMULACRA 2, on the Kodak set at 3244 bytes.
     * Its share beside squared error: 0.04, 0.06, 0.08, 0.12 and 0.18 have -14.6, -12.9, -12.0, -10.6 and -9.5 points,
     * 26.36, 26.29, 26.22, 26.14 and 25.93 dB, and Butteraugli 6.00, 5.99, 5.97, 6.03 and 6.10 (noise 0.05); larger shares
     * draw more lines across textures that are not there. */
    float visual_share;
    /* The weight of the 6-norm of luma's error beside those of SSIMULACRA 2.  200 has Butteraugli 5.93 and -13.2 points, 400
     * 5.90 and -13.7 (means of three seeds). */
    float visual_peaks;
    /* The curvature of its model in steps of the fit; 0.05 to 1 tried, 0.6 costs a point. */
    float curvature_of_steps;
    /* Largest size of its first scale, pixels: bounds the memory of images of more than 32 megapixels. */
    int visual_max_pixels;
};

extern const struct gscl_fit_tunables gscl_fit_tunables;

#endif
