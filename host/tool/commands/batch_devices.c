#include "commands/batch_devices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/device_list.h"
#include "cli/exit_code.h"
#include "cli/message.h"

/* Bytes of a device's memory that an encode takes for each pixel, at most.  Buffers of 1 and 4 megapixels were measured to take 45
 * to 63 bytes with the default settings, at efforts 0 and 1; 92 at 1 bit per pixel, 96 with --tune ssim, and 183 with the paper
 * profile. */
#define ENCODE_BYTES 200
/* The part of a device's memory that encodes may take: 1 / MEMORY_PART.  Drivers, private memory of kernels and other processes
 * need some, too. */
#define MEMORY_PART 2

static device_choice worker_choice(const batch_worker *worker) {
    device_choice choice = worker->batch->choice;
    if (worker->device->id[0])
        choice.device = worker->device->id;
    return choice;
}

/* Images at a time on a device; `info` is NULL where nothing is known of it. */
static int default_jobs(const device_choice *choice, const gscl_device_info *info) {
    if (!info || !is_host_device(info->id))
        return BATCH_OPENCL_WORKERS;
    const uint64_t threads = choice->threads > 0 ? choice->threads : info->compute_units;
    return threads < BATCH_MAX_WORKERS ? (int)threads : BATCH_MAX_WORKERS;
}

uint64_t batch_shared_pixels(const gscl_device_info *info, int workers) {
    return info ? info->memory_bytes / MEMORY_PART / ENCODE_BYTES / (uint64_t)workers : 0;
}

/* Stores a device, for which there is room; `jobs` as for batch_devices_create. */
static void add_device(batch_devices *devices, const gscl_device_info *info, int jobs) {
    batch_device *device = &devices->devices[devices->count++];
    if (info)
        memcpy(device->id, info->id, sizeof info->id);
    device->is_host = is_host_device(device->id);
    device->worker_count = jobs > 0 ? jobs : default_jobs(&devices->choice, info);
    device->shared_pixels = batch_shared_pixels(info, device->worker_count);
    devices->worker_count += (size_t)device->worker_count;
}

/* Makes the workers of all devices. */
static gscl_result make_workers(batch_devices *devices) {
    batch_worker *worker = devices->workers = calloc(devices->worker_count, sizeof *devices->workers);
    if (!worker)
        return GSCL_ERROR_OUT_OF_MEMORY;
    for (size_t i = 0; i < devices->count; i++) {
        batch_device *device = &devices->devices[i];
        device->workers = worker;
        for (int k = 0; k < device->worker_count; k++)
            *worker++ = (batch_worker){.batch = devices, .device = device};
    }
    return GSCL_OK;
}

/* Whether an OpenCL device may be the processor: it is no GPU. */
static bool has_opencl_cpu(const gscl_device_info *infos) {
    for (const gscl_device_info *info = infos; info; info = info->next)
        if (!is_host_device(info->id) && !info->is_gpu)
            return true;
    return false;
}

/* Makes a batch of all devices, of which there is at least one. */
static gscl_result make_all(batch_devices *devices, const gscl_device_info *infos, int jobs) {
    const bool without_host = has_opencl_cpu(infos);
    size_t most = 0;
    for (const gscl_device_info *info = infos; info; info = info->next)
        most++;
    devices->devices = calloc(most, sizeof *devices->devices);
    if (!devices->devices)
        return GSCL_ERROR_OUT_OF_MEMORY;
    for (const gscl_device_info *info = infos; info; info = info->next)
        if (!(without_host && is_host_device(info->id)))
            add_device(devices, info, jobs);
    return make_workers(devices);
}

static gscl_result find_all(batch_devices *devices, int jobs) {
    gscl_device_info *infos = NULL;
    gscl_result result = list_encoders(&infos);
    if (result == GSCL_OK)
        result = infos ? make_all(devices, infos, jobs) : GSCL_ERROR_NO_PLATFORM;
    gscl_free(infos);
    return result;
}

/* Makes a batch of the device of the user's choice, or of the default of the library.  The first worker's context, which is opened
 * here, tells what device that is: a list of all devices would load OpenCL for "host", too.  Where it cannot be opened, the first
 * image reports it. */
static gscl_result find_chosen(batch_devices *devices, int jobs) {
    gscl_context *context = NULL;
    devices->devices = calloc(1, sizeof *devices->devices);
    if (!devices->devices)
        return GSCL_ERROR_OUT_OF_MEMORY;
    if (create_context(&devices->choice, &context) != GSCL_OK)
        gscl_context_free(&context);
    add_device(devices, gscl_context_device(context), jobs);
    const gscl_result result = make_workers(devices);
    if (result == GSCL_OK)
        devices->workers[0].context = context;
    else
        gscl_context_free(&context);
    return result;
}

int batch_devices_create(batch_devices *devices, const device_choice *choice, int jobs) {
    *devices = (batch_devices){.choice = *choice,
                               .is_all = choice->device && strcmp(choice->device, BATCH_ALL) == 0,
                               .lock = PTHREAD_MUTEX_INITIALIZER,
                               .changed = PTHREAD_COND_INITIALIZER};
    const gscl_result result = devices->is_all ? find_all(devices, jobs) : find_chosen(devices, jobs);
    return result == GSCL_OK ? EXIT_SUCCESS : report_result(NULL, "OpenCL", result);
}

void batch_devices_free(batch_devices *devices) {
    for (size_t i = 0; devices->workers && i < devices->worker_count; i++)
        gscl_context_free(&devices->workers[i].context);
    free(devices->workers);
    free(devices->devices);
    devices->workers = NULL;
    devices->devices = NULL;
}

/* Opens a worker's context where all devices work.  One that fails is left out. */
static bool worker_try_to_open(batch_worker *worker) {
    const device_choice choice = worker_choice(worker);
    if (worker->context)
        return true;
    const gscl_result result = create_context(&choice, &worker->context);
    if (result == GSCL_OK)
        return true;
    worker->is_left_out = true;
    if (worker == worker->device->workers) { /* the first one: no worker of this device has a context */
        char text[EXPLANATION_SIZE];
        explain_result(worker->context, result, text);
        report_warning(worker->device->id, "this device is left out: %s", text);
        for (int k = 0; k < worker->device->worker_count; k++)
            worker->device->workers[k].is_left_out = true;
    }
    gscl_context_free(&worker->context);
    return false;
}

/* The first image of an OpenCL device is encoded alone and compiles the kernels of the others. */
static bool device_has_room(const batch_device *device) {
    const bool compiles = !device->is_host && device->finished == 0;
    return device->running < (compiles || device->has_large ? 1 : device->worker_count);
}

static batch_worker *device_idle_worker(batch_devices *devices, batch_device *device) {
    batch_worker *found = NULL;
    pthread_mutex_lock(&devices->lock);
    for (int k = 0; k < device->worker_count && !found && device_has_room(device); k++)
        if (!device->workers[k].is_busy && !device->workers[k].is_left_out)
            found = &device->workers[k];
    pthread_mutex_unlock(&devices->lock);
    return found;
}

batch_worker *batch_devices_idle(batch_devices *devices) {
    for (size_t i = 0; i < devices->count; i++) {
        batch_worker *worker = device_idle_worker(devices, &devices->devices[i]);
        if (worker && (!devices->is_all || worker_try_to_open(worker)))
            return worker;
    }
    return NULL;
}

int batch_worker_open(batch_worker *worker) {
    const device_choice choice = worker_choice(worker);
    return worker->context ? EXIT_SUCCESS : open_device(&choice, &worker->context);
}

void batch_worker_begin(batch_worker *worker, const gscl_image *image) {
    pthread_mutex_lock(&worker->batch->lock);
    worker->is_busy = true;
    worker->device->running++;
    worker->device->has_large = (uint64_t)image->width * image->height > worker->device->shared_pixels;
    pthread_mutex_unlock(&worker->batch->lock);
}

void batch_worker_end(batch_worker *worker) {
    pthread_mutex_lock(&worker->batch->lock);
    worker->is_busy = false;
    worker->device->running--;
    worker->device->finished++;
    pthread_mutex_unlock(&worker->batch->lock);
}

void batch_devices_signal(batch_devices *devices, bool *flag) {
    pthread_mutex_lock(&devices->lock);
    *flag = true;
    devices->endings++;
    pthread_cond_signal(&devices->changed);
    pthread_mutex_unlock(&devices->lock);
}

void batch_devices_wait(batch_devices *devices, uint64_t endings) {
    pthread_mutex_lock(&devices->lock);
    while (devices->endings == endings)
        pthread_cond_wait(&devices->changed, &devices->lock);
    pthread_mutex_unlock(&devices->lock);
}

uint64_t batch_devices_endings(batch_devices *devices, const bool *flag, bool *value) {
    pthread_mutex_lock(&devices->lock);
    if (flag)
        *value = *flag;
    const uint64_t endings = devices->endings;
    pthread_mutex_unlock(&devices->lock);
    return endings;
}
