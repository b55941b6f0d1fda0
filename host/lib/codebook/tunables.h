/* Numbers of the paper profile that were found by trying. */
#ifndef GSCL_LIB_CODEBOOK_TUNABLES_H
#define GSCL_LIB_CODEBOOK_TUNABLES_H

#include <gscl/gscl.h>

struct gscl_codebook_tunables {
    /* The size of the model (codebook_plan.c). */
    double words_scale;          /* words in either book at `words_reference_bits` */
    double words_reference_bits; /* bits; the number of words grows with the square root of the file's bits */
    int min_words, max_words;    /* words in either book */
    double fine_words_bits;      /* bits of a file from which on words have `fine_word_bits` */
    int coarse_word_bits;        /* bits of each dimension of a word */
    int fine_word_bits;          /* likewise, in larger files */
    int position_bits;           /* bits of a coordinate; paper, section 3.3 */
    double side_bits;            /* bits of header and ranges, an estimate */
    double index_saving;         /* bits of a splat's two indices that entropy coding saves, an estimate */
    double bits_per_splat;       /* of files whose number of splats is given, an estimate */
    double splat_surplus;        /* splats fitted for each that the budget holds; the RDO passes drop the others */

    /* The fit (codebook_fit.c).  Fractions are of the steps of free fit and straight-through fit together. */
    int steps[GSCL_MAX_EFFORT + 1]; /* steps for each effort */
    double start_share;             /* fraction of the splats that exist at the first step */
    int densification_rounds;       /* rounds in which the others are added */
    double densification_end;       /* fraction of the steps at which the last round begins */
    int density_control_divisor;    /* one new splat in this number comes from the paper's density control (P7) */
    double replenish_at;            /* fraction of the steps at which dropped splats are replaced */
    double quarter_size_end;        /* fraction of the steps up to which the image has a quarter of its size */
    double half_size_end;           /* likewise, half of its size; full size afterwards */
    double straight_through_start;  /* fraction of the steps after which the straight-through estimator is used */
    int cluster_interval;           /* steps between clusterings */
    int sort_interval;              /* steps between sortings */
    float min_opacity;              /* logit; splats below it are dropped (P7: opacity below 0.001) */
    double learning_rate;           /* factor on the learning rates of cl/update.cl */
    double decay_start;             /* fraction of the steps at which the learning rate begins to fall */
    double final_rate;              /* factor on the learning rate at the last step */

    /* Clustering (codebook_cluster.c). */
    int kmeans_iterations;  /* Lloyd iterations; paper, section 3.3 */
    float scale_metric;     /* relative change of a splat for a change of 1 in ln sigma */
    float max_log_aspect;   /* ln of the ratio of axes beyond which the weight of angles grows no further */
    float direction_offset; /* added to ln aspect as the weight of a splat's direction in the mean of its cluster */
    float opacity_metric;   /* distance of opacities against that of colours ("lower sensitivity", section 3.3) */
    double min_opacity_of_word, max_opacity_of_word; /* 0..1; limits of the mean opacity of a cluster */

    /* RDO passes (codebook_rdo.c). */
    int cell_side;     /* pixels; side of the cells by which overlaps of splats are detected */
    double box_margin; /* pixels around a splat's outline in which it may move */
    float prior_uses;  /* uses added to those of each word, so that no word has infinite bits */

    /* RDO rounds and the budget (codebook_rounds.c). */
    int rounds[GSCL_MAX_EFFORT + 1];      /* RDO rounds for each effort */
    int round_steps[GSCL_MAX_EFFORT + 1]; /* steps of words and positions in each round, for each effort */
    double round_rate;                    /* factor on the learning rates in the first round */
    double round_rate_fall;               /* share of round_rate that is lost by the last round */
    double step_rate_fall;                /* share of the rate that is lost by the last step of a round */
    double last_rate;                     /* factor on round_rate in the steps after the last pass */
    float shape_rate;                     /* learning rate of ln s1, ln s2 and theta of a word */
    float position_rate;                  /* learning rate of a position, in geometric means of the splat's axes */
    double lambda_scale;                  /* of the first round: squared error per bit, as a share of the mean */
    double lambda_gain;                   /* exponent of (size / target size) in the update of lambda */
    double min_lambda_change;             /* smallest factor on lambda after a round */
    double max_lambda_change;             /* largest factor */
    double target_share;                  /* share of the budget that the rounds approach */

    /* Meeting the budget (codebook_rounds.c): passes follow while the file exceeds budget + budget / slack_divisor +
     * slack_bytes.  A smaller excess is removed by cutting off the last splats. */
    int max_budget_passes;  /* number of these passes */
    size_t slack_divisor;   /* of the budget */
    size_t slack_bytes;     /* bytes */
    size_t cut_bytes;       /* bytes of excess for each splat that is cut off at a time; more than a splat takes */
    double min_pass_growth; /* smallest factor on lambda from one of these passes to the next */
    double pass_gain;       /* increase of this factor for a file of twice the budget */
    double max_pass_gain;   /* largest increase */
};

extern const struct gscl_codebook_tunables gscl_codebook_tunables;

#endif
