/* The devices of a batch: one that the user chose, or all of the machine.  Each has workers, which encode an image at a
 * time.  Functions are for the main thread, unless they say otherwise. */
#ifndef GSCL_TOOL_BATCH_DEVICES_H
#define GSCL_TOOL_BATCH_DEVICES_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"

/* Images that an OpenCL device encodes at a time by default: while one occupies the host, the device runs the kernels of the
 * other.  The device "host" encodes as many as it has threads. */
#define BATCH_OPENCL_WORKERS 2
#define BATCH_MAX_WORKERS 64

/* The word for all devices, in place of the name of one: those of OpenCL, and "host" where none of them may be the same
 * processor. */
#define BATCH_ALL "all"

typedef struct batch_worker {
    struct batch_devices *batch;
    struct batch_device *device;
    gscl_context *context; /* NULL until its first image, but for the first worker of a device that the user chose */
    bool is_busy;
    bool is_left_out; /* it has no context */
} batch_worker;

typedef struct batch_device {
    char id[sizeof((gscl_device_info *)0)->id]; /* empty: the one of the user's choice, which cannot be opened */
    bool is_host;
    int worker_count;
    uint64_t shared_pixels; /* an image of more pixels is encoded alone, for the device's memory */
    int running, finished;  /* images */
    bool has_large;         /* the image that began last is encoded alone */
    batch_worker *workers;  /* its part of those of the batch */
} batch_device;

typedef struct batch_devices {
    device_choice choice; /* of the user */
    bool is_all;
    size_t count;
    batch_device *devices;
    size_t worker_count; /* of all devices */
    batch_worker *workers;
    pthread_mutex_t lock; /* guards is_busy, running, finished, endings and the flags that threads of workers set */
    pthread_cond_t changed;
    uint64_t endings; /* threads of workers that ended */
} batch_devices;

/* The most pixels of an image of which all workers of a device can encode one at the same time; 0 where nothing is known of the
 * device (NULL) or of its memory. */
uint64_t batch_shared_pixels(const gscl_device_info *info, int workers);

/* Finds the devices.  Each can encode `jobs` images at a time, 1..BATCH_MAX_WORKERS; 0: the default for the device.  Reports
 * errors and returns the exit code of the program; the caller frees in either case. */
int batch_devices_create(batch_devices *devices, const device_choice *choice, int jobs);
void batch_devices_free(batch_devices *devices);

/* A worker that can begin an image now, or NULL.  With all devices, warns about those that cannot be used. */
batch_worker *batch_devices_idle(batch_devices *devices);

/* Opens the worker's context; reports errors and returns the exit code of the program. */
int batch_worker_open(batch_worker *worker);

/* Begins and ends an image.  Any thread may end it. */
void batch_worker_begin(batch_worker *worker, const gscl_image *image);
void batch_worker_end(batch_worker *worker);

/* For the thread of a worker: sets *flag and wakes the main thread. */
void batch_devices_signal(batch_devices *devices, bool *flag);
/* Waits for a thread that signals, but not for one that `endings` counts already. */
void batch_devices_wait(batch_devices *devices, uint64_t endings);
/* The number of threads that signalled; reads a flag, too, unless `flag` is NULL. */
uint64_t batch_devices_endings(batch_devices *devices, const bool *flag, bool *value);

#endif
