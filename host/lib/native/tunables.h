/* Numbers of this room that were found by trying.  None changes a file or a decoded image; all change speed. */
#ifndef GSCL_LIB_NATIVE_TUNABLES_H
#define GSCL_LIB_NATIVE_TUNABLES_H

struct gscl_native_tunables {
    /* Seconds of work: a launch asks for one more thread for each.  On two processors, 5 to 20e-6 take the same time; 50e-6
     * makes a photograph's encode 3 % slower. */
    double thread_s;
    /* Seconds for which a thread waits for work before it falls asleep, where there is a processor for each thread.  Without
     * it an encode on two processors takes 1.13 times as long; 50 to 200e-6 are as good. */
    double awake_s;
    int parts; /* parts of a launch that each thread is expected to take */
};

extern const struct gscl_native_tunables gscl_native_tunables;

#endif
