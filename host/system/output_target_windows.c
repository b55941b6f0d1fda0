#include "host/system/output_target.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>

#include "host/system/files.h"
#include "host/system/windows_names.h"

/* Names stand for no descriptors, but for standard output. */
int output_descriptor(const char *name) {
    return strcmp(name, "-") == 0 ? 1 : -1;
}

bool output_is_in_place(const char *name) {
    system_status status;
    return output_descriptor(name) >= 0 || (system_status_of(name, &status) && !status.is_regular && !status.is_folder);
}

int output_open_in_place(const char *name) {
    const int descriptor = output_descriptor(name);
    if (descriptor >= 0)
        return _dup(descriptor);
    wchar_t *wide = system_to_wide(name);
    const int file = wide ? _wopen(wide, _O_WRONLY | _O_BINARY | _O_NOINHERIT) : -1;
    free(wide);
    return file;
}

/* Links, which few files are, are replaced. */
char *output_resolve(const char *name) {
    return _strdup(name);
}
