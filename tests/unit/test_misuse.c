/* Two calls with one context at the same time, with runtime/context.c compiled with its debug checks: the program ends with a
 * message that names both.  Calls with contexts of their own are no misuse. */
#define _DEFAULT_SOURCE /* fork, pipe */
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "format/format.h"

#define SIDE 16 /* pixels */

static uint8_t file[64];
static size_t file_size;

/* What a second thread does while the first one decodes. */
typedef struct second_call {
    gscl_context *context;
    bool frees;
    gscl_result result;
} second_call;

static gscl_context *open_host(void) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    return context;
}

/* A file without splats. */
static int make_file(void **state) {
    gsf_coded_image image = {.header = {.layout = GSF_RGB, .has_chroma = true, .width = SIDE, .height = SIDE}};
    (void)state;
    void *scratch = malloc(gsf_scratch_size(&image.header));
    const gsf_result result = scratch ? gsf_write(&image, file, sizeof file, &file_size, scratch) : GSF_NO_SPACE;
    free(scratch);
    return result == GSF_OK ? 0 : -1;
}

static void *run_second_call(void *opaque) {
    second_call *call = opaque;
    gscl_image image = {.pixels = NULL};
    if (call->frees)
        gscl_context_free(&call->context);
    else
        call->result = gscl_decode(call->context, file, file_size, NULL, &image);
    gscl_free(image.pixels);
    return NULL;
}

/* Makes the second call, once, in a thread of its own. */
static bool call_from_another_thread(void *opaque, const gscl_progress *progress) {
    second_call *call = opaque;
    pthread_t thread;
    (void)progress;
    if (call->context && pthread_create(&thread, NULL, run_second_call, call) == 0)
        pthread_join(thread, NULL);
    call->context = NULL;
    return true;
}

static gscl_result decode_beside(gscl_context *context, second_call *call) {
    gscl_decode_settings settings;
    gscl_image image = {.pixels = NULL};
    gscl_decode_settings_default(&settings);
    settings.progress = call_from_another_thread;
    settings.progress_opaque = call;
    const gscl_result result = gscl_decode(context, file, file_size, &settings, &image);
    gscl_free(image.pixels);
    return result;
}

/* Runs in a process of its own, whose standard error is `text` afterwards.  Returns how it ended. */
static int run_misuse(bool frees, char *text, size_t size) {
    int ends[2], status;
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        signal(SIGABRT, SIG_DFL); /* cmocka's handler prints, too */
        dup2(ends[1], STDERR_FILENO);
        gscl_context *context = open_host();
        decode_beside(context, &(second_call){.context = context, .frees = frees});
        _exit(EXIT_SUCCESS);
    }
    close(ends[1]);
    size_t used = 0;
    for (ssize_t count = 1; count > 0 && used + 1 < size; used += count > 0 ? (size_t)count : 0)
        count = read(ends[0], text + used, size - 1 - used);
    text[used] = '\0';
    close(ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    return status;
}

static void assert_named(bool frees, const char *second) {
    char text[4096], expected[128];
    const int status = run_misuse(frees, text, sizeof text);
    snprintf(expected, sizeof expected, "gscl: %s is called with a context that gscl_decode is using", second);
    assert_non_null(strstr(text, expected));
    assert_true(WIFSIGNALED(status));
    assert_int_equal(WTERMSIG(status), SIGABRT);
}

static void test_two_decodes(void **state) {
    (void)state;
    assert_named(false, "gscl_decode");
}

static void test_free_during_decode(void **state) {
    (void)state;
    assert_named(true, "gscl_context_free");
}

static void test_contexts_of_their_own(void **state) {
    (void)state;
    gscl_context *first = open_host(), *second = open_host();
    second_call call = {.context = second, .result = GSCL_ERROR_CANCELLED};
    assert_int_equal(decode_beside(first, &call), GSCL_OK);
    assert_int_equal(call.result, GSCL_OK);
    assert_int_equal(decode_beside(first, &call), GSCL_OK); /* one after the other */
    gscl_context_free(&first);
    gscl_context_free(&second);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_decodes),
        cmocka_unit_test(test_free_during_decode),
        cmocka_unit_test(test_contexts_of_their_own),
    };
    return cmocka_run_group_tests(tests, make_file, NULL);
}
