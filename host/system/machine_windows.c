#include "host/system/machine.h"

#include <windows.h>

double gscl_processor_count(void) {
    DWORD_PTR process, machine;
    double count = 0;
    if (!GetProcessAffinityMask(GetCurrentProcess(), &process, &machine))
        return 0;
    for (; process; process &= process - 1)
        count++;
    return count;
}

uint64_t gscl_memory_bytes(void) {
    MEMORYSTATUSEX status = {.dwLength = sizeof status};
    return GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : 0;
}
