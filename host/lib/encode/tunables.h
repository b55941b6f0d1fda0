/* Numbers of encode/ that were found by trying. */
#ifndef GSCL_LIB_ENCODE_TUNABLES_H
#define GSCL_LIB_ENCODE_TUNABLES_H

struct gscl_encode_tunables {
    double auto_bpp;      /* bits per pixel of GSCL_TARGET_AUTO */
    double auto_bytes;    /* bytes; smallest budget of GSCL_TARGET_AUTO */
    int few_splats;       /* up to this number of splats the background alone may be better; with 2, stripes at 90 bytes
                          lost 4.6 dB to it; to try it takes two drawings */
    int min_visual_bytes; /* bytes; smaller files have the tune PSNR where none is given: on six photographs of 192x128
                             visual costs 0.7 dB and 6 % of Butteraugli at 450 bytes, and 0.1 dB and -8 % at 700 */

    /* The search for effects. */
    int min_probe_bytes;        /* bytes; no effects are tried for smaller files */
    double probe_bits;          /* bits per splat, from which the number of splats of the file is estimated */
    int coherence_level;        /* of the pyramid, counted from the source's, at which edges are examined */
    double coherence_window;    /* radius of the window in which edges should agree, in distances from splat to splat */
    double max_probe_coherence; /* 0..1; images whose edges agree less on a direction may do without ellipses */
    double max_probe_colour;    /* 0..1; root mean square of the colours' differences from grey, up to which the image
                                   may be coded as grey */

    /* The search for a PSNR. */
    int max_trials;         /* encodes */
    double tolerance_db;    /* dB above the target that are accepted */
    double db_per_doubling; /* dB; first guess of how PSNR grows when the bytes double */
    double first_bpp;       /* bits per pixel of the first trial */
    double min_bytes;       /* bytes; smallest first trial */
    double max_bpp;         /* bits per pixel of the largest file that is tried */
    double max_bytes;       /* bytes; where max_bpp is less, the largest file that is tried */
};

extern const struct gscl_encode_tunables gscl_encode_tunables;

#endif
