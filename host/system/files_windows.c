#include "host/system/files.h"

#include <direct.h>
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <share.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <windows.h>

#include "host/system/windows_names.h"

#define WAIT_MS 10 /* between looks at a pipe */
#define SHARE_ALL (FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE)

static HANDLE handle_of(int file) {
    return (HANDLE)_get_osfhandle(file);
}

/* Calls a function of the C library that takes a wide name and returns 0 for success. */
static bool call_with(int function(const wchar_t *), const char *name) {
    wchar_t *wide = system_to_wide(name);
    const bool ok = wide && function(wide) == 0;
    free(wide);
    return ok;
}

static bool take_status(HANDLE handle, system_status *status) {
    BY_HANDLE_FILE_INFORMATION found;
    *status = (system_status){0};
    if (GetFileType(handle) != FILE_TYPE_DISK)
        return true;
    if (!GetFileInformationByHandle(handle, &found)) {
        system_take_error();
        return false;
    }
    status->is_folder = (found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
    status->is_regular = !status->is_folder;
    status->size = (uint64_t)found.nFileSizeHigh << 32 | found.nFileSizeLow;
    status->device = found.dwVolumeSerialNumber;
    status->number = (uint64_t)found.nFileIndexHigh << 32 | found.nFileIndexLow;
    return true;
}

bool system_status_of(const char *name, system_status *status) {
    wchar_t *wide = system_to_wide(name);
    if (!wide)
        return false;
    const HANDLE handle =
        CreateFileW(wide, FILE_READ_ATTRIBUTES, SHARE_ALL, NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);
    if (handle == INVALID_HANDLE_VALUE)
        system_take_error();
    free(wide);
    const bool ok = handle != INVALID_HANDLE_VALUE && take_status(handle, status);
    if (handle != INVALID_HANDLE_VALUE)
        CloseHandle(handle);
    return ok;
}

bool system_status_of_open(int file, system_status *status) {
    return take_status(handle_of(file), status);
}

bool system_is_same(const system_status *a, const system_status *b) {
    return a->device == b->device && a->number == b->number;
}

/* Texts of the C library but for EBUSY, which it calls "Resource device". */
const char *system_error_text(int error) {
    return error == EBUSY ? "another program has it open" : strerror(error);
}

bool system_exists(const char *name) {
    wchar_t *wide = system_to_wide(name);
    const bool exists = wide && _waccess(wide, 0) == 0;
    free(wide);
    return exists;
}

/* Programs that have a file open may forbid to write it, and to remove it, which takes place when another replaces it. */
static bool may_replace(const wchar_t *wide) {
    const HANDLE handle =
        CreateFileW(wide, GENERIC_WRITE | DELETE, SHARE_ALL, NULL, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        system_take_error();
        return false;
    }
    return CloseHandle(handle);
}

bool system_may_write(const char *name) {
    wchar_t *wide = system_to_wide(name);
    const bool ok = wide && may_replace(wide);
    free(wide);
    return ok;
}

/* The C library takes each device for a terminal, NUL among them. */
bool system_is_terminal(int file) {
    DWORD mode;
    return GetConsoleMode(handle_of(file), &mode);
}

FILE *system_open_stream(const char *name) {
    const int file = system_open_to_read(name);
    FILE *stream = file >= 0 ? _fdopen(file, "rb") : NULL;
    if (file >= 0 && !stream)
        _close(file);
    return stream;
}

static int open_file(const char *name, int flags) {
    wchar_t *wide = system_to_wide(name);
    const int file = wide ? _wopen(wide, flags | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE) : -1;
    system_status status;
    const int error = errno;
    const bool is_busy = file < 0 && wide && error == EACCES && _doserrno == ERROR_SHARING_VIOLATION;
    free(wide);
    errno = is_busy ? EBUSY : error;
    if (file < 0 && errno == EACCES && system_status_of(name, &status))
        errno = status.is_folder ? EISDIR : EACCES;
    return file;
}

int system_open_to_read(const char *name) {
    return open_file(name, _O_RDONLY);
}

int system_open_to_append(const char *name) {
    return open_file(name, _O_RDWR | _O_CREAT | _O_APPEND);
}

int system_duplicate(int file) {
    return _dup(file);
}

bool system_make_folder(const char *name) {
    return call_with(_wmkdir, name);
}

bool system_remove_folder(const char *name) {
    return call_with(_wrmdir, name);
}

bool system_remove_file(const char *name) {
    return call_with(_wunlink, name);
}

bool system_replace(const char *from, const char *to) {
    wchar_t *wide_from = system_to_wide(from), *wide_to = system_to_wide(to);
    bool ok = false;
    if (wide_from && wide_to) {
        ok = MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH);
        if (!ok)
            system_take_error();
        /* Windows denies access, and does not say that another program has the file open. */
        if (!ok && errno == EACCES && may_replace(wide_to))
            errno = EACCES;
    }
    free(wide_from);
    free(wide_to);
    return ok;
}

bool system_store(int file) {
    return _commit(file) == 0;
}

/* Windows stores all of a disk for administrators alone. */
void system_store_below(const char *folder) {
    (void)folder;
}

bool system_set_size(int file, uint64_t size) {
    return (errno = _chsize_s(file, (int64_t)size)) == 0;
}

/* A lock keeps others from reading what it covers: here a byte behind the end of any file. */
bool system_lock(int file) {
    OVERLAPPED place = {.OffsetHigh = 0x7fffffff};
    if (LockFileEx(handle_of(file), LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &place))
        return true;
    errno = EWOULDBLOCK;
    return false;
}

int system_make_scratch(void) {
    wchar_t folder[MAX_PATH + 1], name[MAX_PATH + 1];
    if (GetTempPathW(MAX_PATH + 1, folder) == 0 || GetTempFileNameW(folder, L"gsc", 0, name) == 0) {
        system_take_error();
        return -1;
    }
    return _wopen(name, _O_RDWR | _O_TEMPORARY | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
}

static OVERLAPPED place_of(uint64_t offset) {
    return (OVERLAPPED){.Offset = (DWORD)offset, .OffsetHigh = (DWORD)(offset >> 32)};
}

bool system_read_at(int file, void *bytes, size_t size, uint64_t offset) {
    OVERLAPPED place = place_of(offset);
    DWORD done = 0;
    errno = EIO;
    return ReadFile(handle_of(file), bytes, (DWORD)size, &done, &place) && done == size;
}

bool system_write_at(int file, const void *bytes, size_t size, uint64_t offset) {
    OVERLAPPED place = place_of(offset);
    DWORD done = 0;
    errno = ENOSPC;
    return WriteFile(handle_of(file), bytes, (DWORD)size, &done, &place) && done == size;
}

/* Of files and consoles there is always something to read. */
bool system_has_input(int file, int milliseconds) {
    DWORD ready = 0;
    while (GetFileType(handle_of(file)) == FILE_TYPE_PIPE &&
           PeekNamedPipe(handle_of(file), NULL, 0, NULL, &ready, NULL) && ready == 0) {
        if (milliseconds <= 0)
            return false;
        Sleep(WAIT_MS);
        milliseconds -= WAIT_MS;
    }
    return true;
}
