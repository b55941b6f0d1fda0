/* Numbers of this room that were found by trying.  None changes a file or a decoded image; all change speed. */
#ifndef GSCL_LIB_NATIVE_TUNABLES_H
#define GSCL_LIB_NATIVE_TUNABLES_H

struct gscl_native_tunables {
    double thread_s; /* seconds of work: a launch asks for one more thread for each */
    int parts;       /* parts of a launch that each thread is expected to take */
};

extern const struct gscl_native_tunables gscl_native_tunables;

#endif
