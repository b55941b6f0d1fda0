#define _XOPEN_SOURCE 700 /* nftw, mkdtemp */
#include "cli/pocl_cache.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "cli/message.h"

#define POCL_CACHE_MAX_PATH 1024 /* bytes, the NUL included */

/* PoCL looks for its folder in this order.  Returns false for a name that is too long. */
static bool cache_folder(char folder[POCL_CACHE_MAX_PATH]) {
    const char *own = getenv("POCL_CACHE_DIR"), *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    int length;
    if (own)
        length = snprintf(folder, POCL_CACHE_MAX_PATH, "%s", own);
    else if (cache && *cache)
        length = snprintf(folder, POCL_CACHE_MAX_PATH, "%s/pocl/kcache", cache);
    else if (home)
        length = snprintf(folder, POCL_CACHE_MAX_PATH, "%s/.cache/pocl/kcache", home);
    else
        length = snprintf(folder, POCL_CACHE_MAX_PATH, "/tmp/pocl/kcache");
    return length < POCL_CACHE_MAX_PATH;
}

bool pocl_cache_exists(void) {
    char folder[POCL_CACHE_MAX_PATH];
    struct stat status;
    return cache_folder(folder) && stat(folder, &status) == 0 && S_ISDIR(status.st_mode);
}

/* Writes a file to a folder, which shows a full disk too, and removes it.  Returns 0 or an errno. */
static int try_to_write(const char *folder) {
    char name[POCL_CACHE_MAX_PATH + 16];
    static const char block[4096];
    snprintf(name, sizeof name, "%s/gscl-XXXXXX", folder);
    const int file = mkstemp(name);
    if (file < 0)
        return errno;
    const int error = write(file, block, sizeof block) == (ssize_t)sizeof block ? 0 : errno ? errno : ENOSPC;
    close(file);
    unlink(name);
    return error;
}

/* Replaces a path by that of the nearest folder above it. */
static void path_ascend(char *path) {
    char *slash = strrchr(path, '/');
    if (!slash)
        memcpy(path, ".", sizeof ".");
    else if (slash == path)
        path[1] = '\0';
    else
        *slash = '\0';
}

/* Returns 0 when PoCL can write to its folder, and when its name is too long to tell.  Otherwise returns the errno of a
 * trial and the folder's name. */
static int pocl_cache_error(char folder[POCL_CACHE_MAX_PATH]) {
    char existing[POCL_CACHE_MAX_PATH];
    struct stat status;
    errno = 0;
    if (!cache_folder(folder))
        return 0;
    snprintf(existing, sizeof existing, "%s", *folder ? folder : ".");
    while (stat(existing, &status) != 0) {
        if (errno != ENOENT || strcmp(existing, "/") == 0 || strcmp(existing, ".") == 0)
            return errno;
        path_ascend(existing);
    }
    return S_ISDIR(status.st_mode) ? try_to_write(existing) : ENOTDIR;
}

/* Whether the loader of OpenCL finds PoCL: its variable, or a folder of Debian, names the files of implementations.  Returns
 * true where other variables, of other loaders, leave it open. */
static bool may_be_installed(void) {
    char name[POCL_CACHE_MAX_PATH];
    const char *vendors = getenv("OCL_ICD_VENDORS");
    if (getenv("OCL_ICD_FILENAMES") || getenv("OPENCL_VENDOR_PATH"))
        return true;
    if (vendors && strstr(vendors, "pocl"))
        return access(vendors, R_OK) == 0;
    snprintf(name, sizeof name, "%s/pocl.icd", vendors ? vendors : "/etc/OpenCL/vendors");
    return access(name, R_OK) == 0;
}

static char temporary[POCL_CACHE_MAX_PATH]; /* the folder of this process; empty: none */

static int remove_entry(const char *name, const struct stat *status, int kind, struct FTW *place) {
    (void)status, (void)kind, (void)place;
    (void)remove(name);
    return 0;
}

static void remove_temporary(void) {
    nftw(temporary, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

void pocl_cache_prepare(bool quiet) {
    char folder[POCL_CACHE_MAX_PATH];
    const char *parent = getenv("TMPDIR");
    const int error = *temporary || getenv("POCL_CACHE_DIR") || !may_be_installed() ? 0 : pocl_cache_error(folder);
    if (error == 0)
        return;
    const int length =
        snprintf(temporary, sizeof temporary, "%s/gscl-kernels-XXXXXX", parent && *parent ? parent : "/tmp");
    if (length >= (int)sizeof temporary || !mkdtemp(temporary) || setenv("POCL_CACHE_DIR", temporary, 1) != 0) {
        *temporary = '\0';
        return; /* pocl_cache_explain says why PoCL fails */
    }
    atexit(remove_temporary);
    interrupt_set_cleanup(remove_temporary);
    if (!quiet)
        report_note("PoCL cannot write to %s (%s); its kernels are built in a temporary folder, anew each time", folder,
                    strerror(error));
}

bool pocl_cache_explain(char *text, size_t size) {
    char folder[POCL_CACHE_MAX_PATH];
    const int error = may_be_installed() ? pocl_cache_error(folder) : 0;
    if (error != 0)
        snprintf(text, size,
                 "PoCL cannot write to %s, where it keeps built kernels (%s), and does not work without; set the "
                 "variable POCL_CACHE_DIR to another folder",
                 folder, strerror(error));
    return error != 0;
}
