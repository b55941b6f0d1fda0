/* Numbers of scalar/ that were found by trying. */
#ifndef GSCL_LIB_SCALAR_TUNABLES_H
#define GSCL_LIB_SCALAR_TUNABLES_H

#include <gscl/gscl.h>

/* The settings of an effort. */
typedef struct gscl_effort_preset {
    int steps;           /* of the fit */
    int passes;          /* rate-distortion passes, besides the first and those that meet the budget */
    int finest;          /* level of the pyramid that is fitted last, counted from the source's; small images have 0 */
    double surplus;      /* splats fitted for each that the budget holds; the passes drop some again */
    double lambda_scale; /* price of a bit in the first pass: a splat that is dropped too early does not come back */
    double full_share; /* share of the budget; a file that reaches it is full: 0.985 costs efforts with passes 0.02 dB,
                            0.996 takes 1.3 times the time of those without */
    double final_gain; /* of the price by the excess over the budget in the last passes (gscl_scalar_update_lambda):
                            8 and 14 cost 0.03 and 0.05 dB at 0.183 bits a pixel and take as long */
    int searches;      /* of a small file */
} gscl_effort_preset;

extern const gscl_effort_preset gscl_effort_presets[GSCL_MAX_EFFORT + 1];
/* The settings of the probe fits by which effects are decided.  Their files need not be full, and take the fewest passes:
 * on 16 drawings at three budgets the gains of effects change by 0.5 dB at most, and no decision changes. */
extern const gscl_effort_preset gscl_probe_preset;

#define GSCL_LAYERS 4 /* of a progressive file */

struct gscl_scalar_tunables {
    /* Number of splats and steps. */
    double start_share;             /* of the splats that exist at the first step */
    double expected_bits_per_splat; /* bits; first estimate of how many splats a budget holds */
    double min_bits_per_splat;      /* bits; lower bound, because the splats of an unfinished fit take fewer bits */
    double wide_surplus;            /* surplus added where splats are far apart */
    double wide_steps;              /* share of the steps added where splats are far apart and steps take little time;
                                       0.6 costs 0.03 dB at 0.042 and 0.066 bits, and saves 9 % of the time there */
    /* Up to this size, in pixels, steps of the GPU mapping take the time of their launches, whatever their level and the number
     * of splats: the three shares below replace those of the CPU mapping, where coarse levels are fast.  With 0.2, 0.2
     * and 0.45 a fit at 0.042 bits a pixel has 1500 instead of 2375 steps, of which more are at full size.  On six
     * pictures of the Kodak set by which they were chosen it has 0.01 dB more at 0.042 and 0.05 at 0.066 bits, on six others
     * 0.10 and 0.12.  With the visual loss, which needs steps at half the size, they have 0.6 instead of 0.45, and
     * lists that are filled twice as often (gpu_model_bin_interval): at 0.183 bits four pictures are then 0.3 points of SSIMULACRA 2
     * below the CPU mapping instead of 0.9, and six others 0.35, with 0.06 and 0.03 dB more (one seed; seeds differ by up to
     * 0.6 points). */
    double launch_bound_pixels;
    double launch_bound_wide_steps;        /* in place of wide_steps; 0 to 1 */
    double launch_bound_max_quarter_until; /* in place of max_quarter_until: share of the steps */
    double launch_bound_max_half_until; /* in place of max_half_until: share of the steps, at least that of a quarter */
    double launch_bound_max_visual_half_until; /* the same with the visual loss */
    int launch_bound_model_interval; /* in place of model_interval: steps; as gpu_bin_interval, since a model needs new
                                              lists, too; 10 and 16 are within 1 point of SSIMULACRA 2 */
    int launch_bound_models_to_check; /* in place of models_to_check: models; an encode of a photograph at 0.042 bits a pixel
                                         waits 37 to 40 times with 64, 42 with 32 */
    /* Larger images have a smaller share of an effort's steps and passes, so that an encode ends in time:
     * (pixels / large_image_pixels) ^ -large_image_exponent, but at least least_share.  On 25 megapixels at 0.1 bits 3
     * instead of 4 passes cost 0.02 dB for x0.91 of the time; 0.47 instead of 0.54 of the steps, with 2 passes, cost 0.01 dB
     * for x0.96. */
    double large_image_pixels;
    double large_image_exponent;
    double least_share;
    int densify_rounds;   /* rounds in which the other splats are added */
    double densify_until; /* share of the steps, after which the number of splats stays; 0.48 costs 0.03 dB
                                       and 3 % of the time, 0.7 costs 0.06 dB */
    int measure_round;    /* after this round measured bits per splat replace the estimate */

    /* Levels of the pyramid. */
    int small_image_pixels;    /* pixels; up to this size the finest level takes hardly any time */
    double full_size_distance; /* pixels from splat to splat, at which the two shares below hold as they are */
    double quarter_until;      /* share of the steps at a quarter of the size, for splats at full_size_distance */
    double half_until;         /* share of the steps until full size is due, for splats at full_size_distance */
    double max_quarter_until;  /* largest share at a quarter of the size, for splats that are further apart */
    double max_half_until;     /* largest share until full size is due, for splats that are further apart */
    int level_check_interval;  /* steps until a finer level that was refused is considered again */
    /* Share of the fit's error; a level with a smaller residual is skipped.  On a drawn relief of 384x256 at 4300 bytes 0.1
     * stays at half the size, which costs 1.3 dB and 5 points of SSIMULACRA 2 against 0.04; on drawn clouds they are the same. */
    double min_level_residual;
    double rounding_residual; /* squared error per sample: residual of noise by rounding to 8 bits,
                                    (3/4 + 1/64) / 12 / 255^2 */
    double probe_distance;    /* pixels from splat to splat; probe fits of splats further apart use a coarser level */
    int min_covering_splats;  /* fewer splats may leave parts of the image to the background */
    /* The mean of the splats serves as the background up to this factor of the squared error with a stored one, which takes
     * 25 bits.  On starfields, where the mean is seen, 1.0003 and 1.03 give the same files, but for 0.02 dB in one. */
    double max_mean_error;

    /* The fit. */
    double learning_rate;     /* factor of the learning rates in cl/update.cl */
    double min_learning_rate; /* share of learning_rate at the last step */
    /* Squared error per sample below which the learning rate falls with its root, and the least factor by which it does.  On
     * a gradient of 512x256 at 1000 bytes 0, 6e-5, 2.5e-4 and 1e-3 have 53.1, 54.8, 56.2 and 56.4 dB at effort 2 and 57.2,
     * 57.7, 58.8 and 58.6 at effort 5; on drawn reliefs and nebulae 2.5e-4 earns 0.6 and 0.7 dB. */
    double full_rate_above;
    double least_nearness;
    /* The rows of the image that a step sees: every second one, but all of them in a fit of few steps, in the last steps,
     * where the fit is nearly exact, and where many splats are as low as a row.  On twelve pictures of the Kodak set an
     * encode then takes 0.83 of the time, within 0.02 dB. */
    int min_sampled_steps; /* of a whole fit; 100 steps lose 0.09 dB at 0.183 bits a pixel */
    double all_rows_from;  /* share of the steps; 0.85 is as good, 1 costs 0.03 dB */
    double all_rows_below; /* mean squared error per sample; 1e-4 costs 0.5 dB on drawings of 40 dB */
    double max_low_splats; /* share of the splats: up to 0.07 in photographs, 0.2 and more in text and drawings, which
                              lose 0.5 to 3 dB without this bound; 0.2 is as good as 0.15 */
    double quantise_from;  /* share of the steps, from which on the fit draws through the quantiser */
    double max_weighted_distance; /* pixels; splats further apart are not tuned for SSIM.  On four Kodak pictures the
                                     weights change MS-SSIM by -.006 at 150 bytes, 0 at 300; on six by -.001
                                     at 500 (56 pixels), +.001 at 800 (44) against files that are not searched */
    double max_visual_distance;   /* the same for the visual loss: on six Kodak pictures it changes SSIMULACRA 2 by -3.5
                                     at 100 bytes (126 pixels), 1.9 at 200 (90), 4.5 at 300 (73) */
    double adapt_at;              /* share of the steps at which, tuned for SSIM, the target is adapted to the splats */
    double adapt_again_at;        /* share of the steps at which it is adapted once more */
    int sort_interval;            /* steps between sortings in blend alpha */

    /* Progress reports. */
    int report_interval;       /* steps from one to the next */
    int large_report_interval; /* the same of large images, for which the device is waited for */
    double
        min_report_wait_pixels; /* of these; without waiting, the report of a picture of 2 megapixels stood still for 9
                                      of 16 seconds */
    /* What is expected to take which time.  Measured on photographs of 0.4, 2, 6 and 14 megapixels at efforts 0, 2 and 5, where
       each number differs by up to twice; they change the shown time alone. */
    double step_work[3];       /* of a step at full, half and quarter size, in the time of one at full size */
    double pass_work[3];       /* of a rate-distortion pass at these sizes, in steps at full size */
    double scan_work;          /* of its scan for textures, in passes */
    int expected_final_passes; /* that meet the budget: 3 to 13 */
    double expected_change;    /* of the file's size in each of them, as a share of the budget: 0.005 to 0.03 */

    /* The search of small files.  Tried on eight pictures of the Kodak set at 60 to 500 bytes; dB are their means. */
    int max_search_bytes;    /* bytes of the first file that is not searched: at 700 the search earns 0.08 dB for 1.3
                                times the time, and the tune psnr passes visual in SSIMULACRA 2 on small images */
    int search_first_steps;  /* of the fit before the search, in all efforts */
    int search_first_passes; /* passes before the search, in all efforts */
    double search_pixels;    /* of the level of the search, at least; with 6000 two pictures lost 0.14 dB */
    double search_distance;  /* pixels of that level from splat to splat, at least; with 10 500 bytes lose 0.03 dB */
    int search_starts;       /* of a search, whose results are combined; 3 with 6 rounds each are 0.02 dB worse */
    int search_rounds;       /* of each start */
    int search_combinations; /* rounds after the last start of a search, of which every second one combines; none that
                                combines costs 0.04 dB at 100 bytes, all of them 0.045 */
    double search_taken_weight;   /* of the gain of a part, each time that it has been taken */
    double search_size_slope;     /* of the logarithm of the error, by that of the size */
    double search_size_curvature; /* the same, by its square; 0 keeps images that are far too small */
    double search_removed;     /* share of the splats that a round removes; 0 to 0.05 are as good, 0.08 costs 0.05 dB */
    double search_added;       /* share of the splats that it adds besides; 0.03 to 0.05 are as good */
    int search_steps;          /* of the fit in a round; 150 take 0.95 times as long and cost 0.03 dB at 300 bytes */
    int search_passes;         /* rate-distortion passes in a round; 2 and 5 are as good */
    double search_first_price; /* lambda in the first round, in units of error / (2 * bits of the budget) */
    double search_price_gain;  /* exponent of the price by the size after a round; 1, without splats for
                                  the bytes that are missing, costs 0.06 dB at 300 bytes */
    double search_final_pixels; /* of the level of the last part, at least */
    double search_wave_pixels;  /* the same where waves are tried: at 90000 they cost a picture 0.5 dB */
    int search_wave_bytes;      /* bytes of the smallest searched file with waves: at 150 they earn a picture 0.6 dB */
    int search_additions;       /* trials to use bytes that are left, by more splats */
    int search_trials;          /* prices tried to meet the budget */
    double search_price_step;   /* from the first to the second of them, then squared; with 1.3 and 2 files end a byte
                                   or two shorter */
    double search_fit_share;    /* share of the time at the end of the fit, for the progress report */
    double search_passes_share; /* the same at the end of the passes */

    /* The tune visual; points are those of SSIMULACRA 2, on three pictures of the Kodak set. */
    double model_from;   /* share of the steps without the visual loss.  On the whole set at 3244 bytes, with a
                                  visual_share of 0.08, Butteraugli is 5.97, 5.95 and 6.02 with 0.15, 0.3 and 0.5, and
                                  0.5 costs 0.7 points */
    int model_interval;  /* steps from model to model: 5 measures the same, 10 of 600 cost 1 to 3 points */
    int models_to_check; /* models from one look at the error, for which the host waits, to the next; 16 is 112 steps */
    /* Squared error per sample below which the tune visual goes on with squared error alone.  On 26 drawn pictures of 384x256
     * at 4300 bytes (nebulae, logos, stars, cells) SSIMULACRA 2 is 89.3 with 0, 91.2 with 2e-5 (47 dB), 91.5 with 6e-5 and an
     * end where the first visual loss is low, too; on 53 photographs of 98000 pixels at 2064 bytes that costs 0.8 points, of
     * some 9, and 2e-5 nothing. */
    double min_visual_error;
    float curvature_of_passes; /* of the model in rate-distortion passes; 0.3 to 1 tried, 1 costs a point */

    /* Artefacts (gscl_scalar_rdo_settings).  dB are means of the Kodak set at 0.042 and 0.183 bits a pixel, of both. */
    double elongation_price; /* 0.1, 0.3 and 0.5 cost 0.00 to 0.02 dB; at 0 needles cross textured areas */
    double min_explained; /* 0.05 costs 0.02 dB, 0.1 0.03, 0.25 0.10 (and 0.1 0.4 on noise in the blend sum); at 0 files
                                below 0.05 bits show false gratings */

    /* Textures. */
    int texture_effort;        /* from this effort on textures are tried */
    int scan_interval;         /* passes from one scan for textures to the next */
    double min_textured_share; /* of the splats; where fewer took a wave at the first scan, no others are tried */

    /* The loop of passes around the byte budget. */
    double budget_aim;         /* share of the budget that the passes aim at */
    double densify_below;      /* share of the budget; a smaller file has room for more splats */
    int densify_steps_divisor; /* the fit's steps divided by this: steps of a refit after densification */
    int max_densify_steps;     /* steps of a refit */
    int max_densifications;    /* densifications after the first pass */
    double max_densify_growth; /* of the error, by a densification that stays: on ramps with hard edges it was 15, and
                                  undoing it gained 8 dB; 1 leaves files of fine texture nearly empty */
    double lambda_gain;        /* exponent of lambda by excess size while the file shrinks towards its budget */
    double excess_exponent;    /* of the share of passes left: how the excess over the budget shrinks */
    double refund_gain;   /* exponent of lambda by the size after a pass that made the file too small; 18 is as good */
    double slack_factor;  /* of lambda in a pass that uses bytes that are left */
    int max_final_passes; /* passes that bring a file below its budget */
    int max_slack_passes; /* passes that use bytes that are left */
    /* Refits of the splats that are left where a price this high dropped needed ones.  On twelve Kodak pictures of 1000 to
     * 8994 bytes the highest price is 0.5 to 6, and refits would earn 0.02 dB at 2064 bytes and 0.006 at 8994, for a fifth
     * of the time.  On smooth drawings it is 7 to 180, and they earn 0 to 10 dB, for up to half of the time. */
    double refit_lambda_scale;
    int max_refits; /* a third earns 0.1 dB */
    int steps_after_drops;
    double min_lambda_scale; /* lower bound of lambda_scale */
    double max_lambda_scale; /* upper bound of lambda_scale */

    /* Layers of a progressive file. */
    double layer_shares[GSCL_LAYERS]; /* of the target, up to the end of each layer; the last is 1 */
    double min_layer_bytes;           /* bytes; a smaller base layer is left to the next layer */

    /* One rate-distortion pass. */
    double rdo_growth;        /* factor by which a splat's box may grow in a pass */
    double rdo_growth_pixels; /* pixels by which it may grow besides */
    int rdo_visits;           /* of a splat, each of which may change its place or shape once.  On 24 photographs 1
                                  costs 0.04 dB at 0.042 bits per pixel against 2 */
    float move_slack;        /* bits: a move is evaluated if it is predicted to cost at most so much more than none.  0,
                                  2, 6 and no bound are as good to 0.02 dB; 0 saves 3 % of an encode's time against 2 */
    double rdo_count_floor;  /* occurrences that each code counts as having, besides its own */
    double rdo_count_spread; /* share of a count that comes from its neighbours: the entropy coder spreads, too */
    double rdo_textured_share; /* of the splats that are assumed to take a wave */
    double rdo_texture_count;  /* occurrences that each texture code is assumed to have, besides its own */
};

extern const struct gscl_scalar_tunables gscl_scalar_tunables;

#endif
