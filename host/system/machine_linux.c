#define _GNU_SOURCE /* sched_getaffinity */
#include "host/system/machine.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_PATH 1024 /* bytes of a path, the NUL included */

static int processors_of_affinity(void) {
    cpu_set_t set;
    return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 0; /* fails beyond 1024 processors */
}

/* Reads the numbers at the beginning of a file; returns how many there are, at most `count`. */
static int read_numbers(const char *path, double *numbers, int count) {
    char line[128] = "";
    FILE *file = fopen(path, "r");
    if (!file)
        return 0;
    const char *rest = fgets(line, sizeof line, file);
    fclose(file);
    for (int i = 0; i < count; i++) {
        char *end = NULL;
        numbers[i] = rest ? strtod(rest, &end) : 0;
        if (end == rest || !rest)
            return i;
        rest = end;
    }
    return count;
}

/* The processors of "QUOTA PERIOD" in cpu.max of a group; infinite for "max", or where the file is missing. */
static double quota_of_version_2(const char *folder) {
    char path[MAX_PATH + 32];
    double numbers[2];
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/cpu.max", folder);
    return read_numbers(path, numbers, 2) == 2 && numbers[0] > 0 && numbers[1] > 0 ? numbers[0] / numbers[1] : INFINITY;
}

static double number_in(const char *folder, const char *name) {
    char path[MAX_PATH + 64];
    double number;
    snprintf(path, sizeof path, "/sys/fs/cgroup/cpu%s/%s", folder, name);
    return read_numbers(path, &number, 1) == 1 ? number : 0;
}

static double quota_of_version_1(const char *folder) {
    const double quota = number_in(folder, "cpu.cfs_quota_us"), period = number_in(folder, "cpu.cfs_period_us");
    return quota > 0 && period > 0 ? quota / period : INFINITY;
}

/* The least quota of a group and of those above it; in a container the group may be the root of what is mounted. */
static double least_quota(char *folder, double quota_of(const char *)) {
    double least = quota_of("");
    while (*folder) {
        least = fmin(least, quota_of(folder));
        char *slash = strrchr(folder, '/');
        if (!slash)
            break;
        *slash = '\0';
    }
    return least;
}

/* Lines of /proc/self/cgroup are NUMBER:CONTROLLERS:FOLDER; the controllers of version 2 are empty. */
static double quota_of_groups(void) {
    char line[MAX_PATH];
    double least = INFINITY;
    FILE *file = fopen("/proc/self/cgroup", "r");
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        char *controllers = strchr(line, ':'), *folder = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!folder)
            continue;
        *folder++ = '\0';
        controllers++;
        if (!*controllers)
            least = fmin(least, least_quota(folder, quota_of_version_2));
        else if (strcmp(controllers, "cpu") == 0 || strcmp(controllers, "cpu,cpuacct") == 0)
            least = fmin(least, least_quota(folder, quota_of_version_1));
    }
    if (file)
        fclose(file);
    return least;
}

double gscl_processor_count(void) {
    double count = processors_of_affinity();
    if (count < 1)
        count = (double)sysconf(_SC_NPROCESSORS_ONLN);
    return fmin(count, ceil(quota_of_groups()));
}

uint64_t gscl_memory_bytes(void) {
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page : 0;
}
