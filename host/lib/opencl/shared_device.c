#include "opencl/shared_device.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "opencl/build_options.h"
#include "opencl/cl_error.h"
#include "opencl/opencl_device.h"

#define MAX_PROGRAMS 64 /* an encode has about ten; of what is beyond, each context builds its own */

typedef struct shared_program {
    gscl_program_kind kind;
    char options[GSCL_MAX_BUILD_OPTIONS];
    cl_program program; /* NULL: a thread is building it */
} shared_program;

struct gscl_shared_device {
    struct gscl_shared_device *next;
    cl_device_id id;
    cl_context context;
    pthread_mutex_t lock; /* guards all below */
    pthread_cond_t built; /* a program, or it could not be built */
    size_t program_count;
    shared_program programs[MAX_PROGRAMS];
    gscl_opencl_device *users; /* a list by next_user */
};

/* All devices that are open, and whether one is opened or closed. */
static pthread_mutex_t devices_lock = PTHREAD_MUTEX_INITIALIZER;
static struct gscl_shared_device *devices;

/* ---- Users ---- */

/* Logs a notice of the OpenCL implementation, which may call this function at any time and from any thread, for one of the
 * contexts. */
static void CL_CALLBACK log_notice(const char *text, const void *details, size_t size, void *opaque) {
    struct gscl_shared_device *shared = opaque;
    (void)details;
    (void)size;
    pthread_mutex_lock(&shared->lock);
    if (shared->users)
        gscl_log(shared->users->owner, GSCL_LOG_WARNING, "OpenCL: %s", text ? text : "");
    pthread_mutex_unlock(&shared->lock);
}

static void add_user(struct gscl_shared_device *shared, gscl_opencl_device *user) {
    pthread_mutex_lock(&shared->lock);
    user->shared = shared;
    user->next_user = shared->users;
    shared->users = user;
    pthread_mutex_unlock(&shared->lock);
}

/* Whether others are left. */
static bool remove_user(struct gscl_shared_device *shared, gscl_opencl_device *user) {
    pthread_mutex_lock(&shared->lock);
    gscl_opencl_device **place = &shared->users;
    while (*place != user)
        place = &(*place)->next_user;
    *place = user->next_user;
    user->shared = NULL;
    const bool has_users = shared->users != NULL;
    pthread_mutex_unlock(&shared->lock);
    return has_users;
}

/* ---- Opening and closing; the caller holds devices_lock ---- */

static struct gscl_shared_device **find_device(cl_device_id id) {
    struct gscl_shared_device **place = &devices;
    while (*place && (*place)->id != id)
        place = &(*place)->next;
    return place;
}

static struct gscl_shared_device *add_device(cl_device_id id) {
    struct gscl_shared_device *shared = calloc(1, sizeof *shared);
    if (!shared)
        return NULL;
    shared->id = id;
    pthread_mutex_init(&shared->lock, NULL);
    pthread_cond_init(&shared->built, NULL);
    shared->next = devices;
    devices = shared;
    return shared;
}

static gscl_result create_context(gscl_context *context, struct gscl_shared_device *shared) {
    const gscl_opencl_device *device = gscl_opencl(context);
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, (cl_context_properties)device->platform, 0};
    cl_int error;
    shared->context = gscl_cl.clCreateContext(properties, 1, &device->id, log_notice, shared, &error);
    return error == CL_SUCCESS ? GSCL_OK : gscl_cl_fail(context, error, "clCreateContext", "");
}

static void free_device(struct gscl_shared_device *shared) {
    *find_device(shared->id) = shared->next;
    for (size_t i = 0; i < shared->program_count; i++)
        gscl_cl.clReleaseProgram(shared->programs[i].program);
    if (shared->context)
        gscl_cl.clReleaseContext(shared->context);
    pthread_cond_destroy(&shared->built);
    pthread_mutex_destroy(&shared->lock);
    free(shared);
}

static void leave(gscl_context *context) {
    struct gscl_shared_device *shared = gscl_opencl(context)->shared;
    if (!remove_user(shared, gscl_opencl(context)))
        free_device(shared);
}

static gscl_result join(gscl_context *context) {
    gscl_opencl_device *device = gscl_opencl(context);
    struct gscl_shared_device *shared = *find_device(device->id);
    if (!shared)
        shared = add_device(device->id);
    if (!shared)
        return gscl_fail_memory(context);
    add_user(shared, device); /* before there is an OpenCL context, whose notices it gets */
    const gscl_result result = shared->context ? GSCL_OK : create_context(context, shared);
    device->context = shared->context;
    if (result != GSCL_OK)
        leave(context);
    return result;
}

gscl_result gscl_shared_device_join(gscl_context *context) {
    pthread_mutex_lock(&devices_lock);
    const gscl_result result = join(context);
    pthread_mutex_unlock(&devices_lock);
    return result;
}

void gscl_shared_device_leave(gscl_context *context) {
    pthread_mutex_lock(&devices_lock);
    if (gscl_opencl(context)->shared)
        leave(context);
    pthread_mutex_unlock(&devices_lock);
}

/* ---- Programs; the caller holds the device's lock ---- */

static shared_program *find_program(struct gscl_shared_device *shared, gscl_program_kind kind, const char *options) {
    for (size_t i = 0; i < shared->program_count; i++)
        if (shared->programs[i].kind == kind && strcmp(shared->programs[i].options, options) == 0)
            return &shared->programs[i];
    return NULL;
}

/* Notes that a program is being built. */
static void note_begun(struct gscl_shared_device *shared, gscl_program_kind kind, const char *options) {
    if (shared->program_count == MAX_PROGRAMS)
        return;
    shared_program *begun = &shared->programs[shared->program_count++];
    *begun = (shared_program){.kind = kind};
    snprintf(begun->options, sizeof begun->options, "%s", options);
}

/* Waits, without the lock, while another thread builds a program, and tells the caller of it. */
static void wait_for_build(gscl_context *context, struct gscl_shared_device *shared, gscl_program_kind kind,
                           const char *options) {
    pthread_mutex_unlock(&shared->lock);
    gscl_report_build(context, true);
    pthread_mutex_lock(&shared->lock);
    for (const shared_program *p = find_program(shared, kind, options); p && !p->program;
         p = find_program(shared, kind, options))
        pthread_cond_wait(&shared->built, &shared->lock);
    pthread_mutex_unlock(&shared->lock);
    gscl_report_build(context, false);
    pthread_mutex_lock(&shared->lock);
}

cl_program gscl_shared_program_take(gscl_context *context, gscl_program_kind kind, const char *options) {
    struct gscl_shared_device *shared = gscl_opencl(context)->shared;
    const shared_program *found;
    pthread_mutex_lock(&shared->lock);
    while ((found = find_program(shared, kind, options)) && !found->program)
        wait_for_build(context, shared, kind, options);
    const cl_program program = found ? found->program : NULL;
    if (program)
        gscl_cl.clRetainProgram(program);
    else
        note_begun(shared, kind, options);
    pthread_mutex_unlock(&shared->lock);
    return program;
}

void gscl_shared_program_give(gscl_context *context, gscl_program_kind kind, const char *options, cl_program program) {
    struct gscl_shared_device *shared = gscl_opencl(context)->shared;
    pthread_mutex_lock(&shared->lock);
    shared_program *begun = find_program(shared, kind, options);
    if (begun && !begun->program && program) {
        gscl_cl.clRetainProgram(program);
        begun->program = program;
    } else if (begun && !begun->program) {
        *begun = shared->programs[--shared->program_count];
    }
    pthread_cond_broadcast(&shared->built);
    pthread_mutex_unlock(&shared->lock);
}
