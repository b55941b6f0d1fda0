#include "commands/batch_devices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/exit_code.h"
#include "cli/message.h"

#define LARGE_IMAGE (4u << 20) /* pixels; a larger image is encoded alone on its device, for its memory */

static device_choice worker_choice(const batch_worker *worker) {
    device_choice choice = worker->batch->choice;
    if (worker->batch->is_all)
        choice.device = worker->device->id;
    return choice;
}

/* Copies the ids of all devices. */
static int list_ids(batch_devices *devices) {
    gscl_device_info *infos = NULL;
    const gscl_result result = gscl_list_devices(&infos);
    if (result != GSCL_OK)
        return report_result(NULL, "OpenCL", result);
    for (const gscl_device_info *info = infos; info; info = info->next)
        devices->count++;
    devices->devices = calloc(devices->count, sizeof *devices->devices);
    size_t i = 0;
    for (const gscl_device_info *info = infos; devices->devices && info; info = info->next)
        memcpy(devices->devices[i++].id, info->id, sizeof info->id);
    gscl_free(infos);
    return EXIT_SUCCESS;
}

/* Makes the workers of all devices.  Returns false when out of memory. */
static bool make_workers(batch_devices *devices) {
    const size_t each = (size_t)devices->worker_count;
    devices->workers = calloc(devices->count * each, sizeof *devices->workers);
    if (!devices->workers)
        return false;
    for (size_t i = 0; i < devices->count * each; i++) {
        batch_device *device = &devices->devices[i / each];
        devices->workers[i] = (batch_worker){.batch = devices, .device = device};
        if (i % each == 0)
            device->workers = &devices->workers[i];
    }
    return true;
}

int batch_devices_create(batch_devices *devices, const device_choice *choice, int worker_count) {
    *devices = (batch_devices){.choice = *choice,
                               .worker_count = worker_count,
                               .is_all = choice->device && strcmp(choice->device, BATCH_ALL) == 0,
                               .lock = PTHREAD_MUTEX_INITIALIZER,
                               .changed = PTHREAD_COND_INITIALIZER};
    int status = EXIT_SUCCESS;
    if (devices->is_all)
        status = list_ids(devices);
    else
        devices->devices = calloc(devices->count = 1, sizeof *devices->devices);
    if (status == EXIT_SUCCESS && !(devices->devices && make_workers(devices))) {
        report_error("OpenCL", "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        status = EXIT_FAILURE;
    }
    return status;
}

void batch_devices_free(batch_devices *devices) {
    for (size_t i = 0; devices->workers && i < devices->count * (size_t)devices->worker_count; i++)
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
        for (int k = 0; k < worker->batch->worker_count; k++)
            worker->device->workers[k].is_left_out = true;
    }
    gscl_context_free(&worker->context);
    return false;
}

/* The first image of a device is encoded alone and compiles the kernels of the others. */
static bool device_has_room(const batch_devices *devices, const batch_device *device) {
    return device->running < (device->finished == 0 || device->has_large ? 1 : devices->worker_count);
}

static batch_worker *device_idle_worker(batch_devices *devices, batch_device *device) {
    batch_worker *found = NULL;
    pthread_mutex_lock(&devices->lock);
    for (int k = 0; k < devices->worker_count && !found && device_has_room(devices, device); k++)
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
    worker->device->has_large = (uint64_t)image->width * image->height > LARGE_IMAGE;
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
