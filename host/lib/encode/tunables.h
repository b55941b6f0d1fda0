/* Numbers of encode/ that were found by trying. */
#ifndef GSCL_LIB_ENCODE_TUNABLES_H
#define GSCL_LIB_ENCODE_TUNABLES_H

/* The search for a quality, for one measure (quality_search.h).  Its scale is what grows by about the same for each doubling
 * of the bytes: quality itself or, where `perfect` is given, -log2(perfect - quality).  Figures are those of photographs and
 * drawings of the corpus (tests/bench/corpus.txt, train), 0.02 to 0.54 bits per pixel at effort 5.  A wrong slope, gain or
 * offset costs trials, never quality. */
typedef struct gscl_quality_tunables {
    double perfect;      /* quality of equal images; 0: the measure is its own scale, as dB */
    double tolerance;    /* quality above the target that is accepted.  1 point is about 3 % of the bytes, and files of
                             small images whose sizes differ by 2 % differ by as much; half of it takes further trials */
    double aim;          /* quality above the target at which sizes aim; at 0 half of all last trials would miss it */
    double per_doubling; /* of the scale, when the bytes double: a first guess.  SSIMULACRA 2: 0.18 to 0.6, median 0.44;
                             PSNR: 1.6 to 5 dB */
    double slope_range;  /* slopes that are measured are limited to a factor of it either way */
    double slope_octaves; /* octaves; least ratio of two sizes from which a slope is taken: noise is 1 to 3 points */
    double first_quality; /* of a file of first_bpp, in the mean */
    int max_probes;       /* a third one is rare; with 6 a picture of fine lines, of which effort 0 hardly gains by more
                             bytes, took three times as long */
    int max_small_probes; /* the same where the next is smaller than the last one: with 3, smooth pictures of which 22
                             bytes are enough took twice as long */
    double probe_octaves; /* octaves; a probe whose size is that near to the one sought is the last one */
    double probe_reach;   /* octaves; how far from one probe the next one, or the first trial, may be: at high qualities
                             effort 0 hardly gains by more bytes */
    double probe_gain; /* where effort 0 has p on the scale at b bits per pixel, a complete encode has probe_gain * p +
                             probe_octave * log2(b) + probe_offset.  Root mean square of the error: SSIMULACRA 2 0.11, a
                             quarter of an octave of size; PSNR 1.2 dB */
    double probe_octave; /* on the scale, for each doubling of the bits per pixel */
    double probe_offset; /* on the scale */
    double
        patience; /* share by which `tolerance` and narrow_share grow with each trial after the third one, up to twice */
} gscl_quality_tunables;

struct gscl_encode_tunables {
    double auto_bpp;       /* bits per pixel of GSCL_TARGET_AUTO */
    double auto_bytes;     /* bytes; smallest budget of GSCL_TARGET_AUTO and GSCL_TARGET_RATE */
    double max_splat_bits; /* more bits than a splat takes in any file: a noisy picture of 64x64 pixels with all splats
                              that are of use takes 35, in the paper profile 37 */
    int few_splats; /* up to this number of splats the background alone may be better; with 2, stripes at 90 bytes
                          lost 4.6 dB to it; to try it takes two drawings */
    double
        packet_slack; /* bytes of each of several packets that stay free, so that all can be filled evenly: on 6 photographs of
                            256x171 in ten packets of 152 bytes 0.3 costs 0.2 dB, 3 costs 0.08, 1.5 costs 0.01 */
    /* Repair packets (repairs.h).  Measured on 12 photographs at 1520 bytes in 10 packets, of 256x171 and 768x512 pixels. */
    double packet_doubling; /* dB that twice the bytes bring */
    double
        packet_all_lost; /* dB that a loss of nearly all packets costs; that of a share of them costs its square root of
                               it: 5.3 and 3.8 dB for a fifth, 8.0 and 5.9 for two fifths */
    double packet_failure; /* 0..1; share of pictures that may lose more packets than there are repair packets: above it
                              one packet more repairs, where that costs no more than the reserve.  With 0.05 ten packets of
                              which 20 % are lost do not arrive whole in 3.3 of 100 cases, with 0.02 in 0.6; with 0.01
                              those of which 5 % are lost have 0.4 dB less where none is */
    double
        packet_reserve; /* dB of the expected quality that this may cost; with 0.8 six of ten packets repair at 20 %, and
                              a picture of which none is lost has 1 dB less */
    int min_visual_bytes; /* bytes; smaller files have the tune PSNR where none is given: on six photographs of 192x128
                             visual costs 0.7 dB and 6 % of Butteraugli at 450 bytes, and 0.1 dB and -8 % at 700 */
    /* dB; a file whose PSNR is higher is compared with the largest one that is searched (scalar/tunables.h).  On
     * drawn gradients, glows and ripples of 192x128, files of 800 to 1800 bytes are up to 2.6 dB worse than that without it
     * (53 and 55.9 dB), for an encode in twice the time.  Lower ones were not tried: photographs have 20 to 45 dB. */
    double min_smooth_psnr;
    double max_smooth_pixels; /* of an image that is compared so; its source stays in memory for it */

    /* The search for effects. */
    int min_probe_bytes;        /* bytes; no effects are tried for smaller files */
    double probe_bits;          /* bits per splat, from which the number of splats of the file is estimated */
    int coherence_level;        /* of the pyramid, counted from the source's, at which edges are examined */
    double coherence_window;    /* radius of the window in which edges should agree, in distances from splat to splat */
    double max_probe_coherence; /* 0..1; images whose edges agree less on a direction may do without ellipses */
    double max_probe_colour;    /* 0..1; root mean square of the colours' differences from grey, up to which the image
                                   may be coded as grey */

    /* The search for a quality. */
    gscl_quality_tunables psnr;        /* dB */
    gscl_quality_tunables ssimulacra2; /* points */
    int min_probing_effort; /* lower efforts have no probes: complete encodes take only two or three times as long */
    int max_trials;         /* encodes, without probes; searches for a SSIMULACRA 2 take 3 in the mean */
    double probes_share;    /* 0..1; of the time of a search, that probes are expected to take, for its progress */
    double first_bpp;       /* bits per pixel of a first file of the mean quality */
    double min_bytes;       /* bytes; smallest first file */
    double max_bpp;         /* bits per pixel of the largest file that is tried */
    double max_bytes;       /* bytes; where max_bpp is less, the largest file that is tried */
    double narrow_share; /* 0..1; of the bytes: sizes that differ by less are not told apart.  With 0.01 a photograph of
                               387x258 took 5 trials instead of 3 and saved 3 % */
    double narrow_bytes; /* the same in bytes */
};

extern const struct gscl_encode_tunables gscl_encode_tunables;

#endif
