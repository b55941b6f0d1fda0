#include "host/system/temporaries.h"

#include <fcntl.h>
#include <io.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

#include "host/system/windows_names.h"

/* Opens a file that no other process can write or open so meanwhile, but rename and remove; -1 with errno. */
static int open_alone(const char *name, DWORD how) {
    wchar_t *wide = system_to_wide(name);
    if (!wide)
        return -1;
    const HANDLE handle = CreateFileW(wide, GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_DELETE, NULL,
                                      how, FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle == INVALID_HANDLE_VALUE)
        system_take_error();
    free(wide);
    return handle == INVALID_HANDLE_VALUE ? -1 : _open_osfhandle((intptr_t)handle, _O_BINARY | _O_NOINHERIT);
}

int system_make_temporary(char *name) {
    const int file = open_alone(name, CREATE_ALWAYS);
    if (file >= 0)
        return file;
    char *slash = strrchr(name, '/');
    snprintf(slash ? slash + 1 : name, sizeof TEMPORARY_PATTERN, ".gscl-%06lx", GetCurrentProcessId() & 0xffffff);
    return open_alone(name, CREATE_NEW);
}

/* A file that is open alone needs no lock. */
int system_keep_lock(int file) {
    (void)file;
    return 0;
}

/* A folder gives its permissions to the files in it. */
void system_take_permissions(int file, const char *target) {
    (void)file, (void)target;
}

void system_remove_temporary(const char *name) {
    wchar_t *wide = system_to_wide(name);
    const int file = wide ? open_alone(name, OPEN_EXISTING) : -1;
    if (file >= 0) {
        DeleteFileW(wide);
        _close(file);
    }
    free(wide);
}
