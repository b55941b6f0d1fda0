#include "native/processor.h"

#include <string.h>

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#include <stdint.h>

/* Bits of the registers that CPUID sets, and those of the levels of the psABI for x86-64 that are tested here. */
enum { ONE_C, ONE_D, SEVEN_B, EXTENDED_C, REGISTERS };
enum { XMM_YMM = 6, ZMM = 0xe6 }; /* of XCR0: states that the operating system keeps */
#define BIT(n) (1u << (n))

typedef struct level {
    const char *name;
    uint32_t needs[REGISTERS];
    uint64_t states;
} level;

static const level levels[] = {
    {"i686_sse2", {[ONE_D] = BIT(25) | BIT(26)}, 0}, /* SSE, SSE2 */
    /* SSE3, SSSE3, CMPXCHG16B, SSE4.1, SSE4.2, POPCNT; LAHF */
    {"x86_64_v2", {[ONE_C] = BIT(0) | BIT(9) | BIT(13) | BIT(19) | BIT(20) | BIT(23), [EXTENDED_C] = BIT(0)}, 0},
    /* these; FMA, MOVBE, OSXSAVE, AVX, F16C; BMI1, AVX2, BMI2; LZCNT */
    {"x86_64_v3",
     {[ONE_C] =
          BIT(0) | BIT(9) | BIT(12) | BIT(13) | BIT(19) | BIT(20) | BIT(22) | BIT(23) | BIT(27) | BIT(28) | BIT(29),
      [SEVEN_B] = BIT(3) | BIT(5) | BIT(8),
      [EXTENDED_C] = BIT(0) | BIT(5)},
     XMM_YMM},
    /* these; AVX512 F, DQ, CD, BW, VL */
    {"x86_64_v4",
     {[ONE_C] =
          BIT(0) | BIT(9) | BIT(12) | BIT(13) | BIT(19) | BIT(20) | BIT(22) | BIT(23) | BIT(27) | BIT(28) | BIT(29),
      [SEVEN_B] = BIT(3) | BIT(5) | BIT(8) | BIT(16) | BIT(17) | BIT(28) | BIT(30) | BIT(31),
      [EXTENDED_C] = BIT(0) | BIT(5)},
     ZMM},
};

static void read_registers(uint32_t has[REGISTERS]) {
    uint32_t a, b, c, d;
    memset(has, 0, REGISTERS * sizeof *has);
    if (__get_cpuid(1, &a, &b, &c, &d))
        has[ONE_C] = c, has[ONE_D] = d;
    if (__get_cpuid_count(7, 0, &a, &b, &c, &d))
        has[SEVEN_B] = b;
    if (__get_cpuid(0x80000001, &a, &b, &c, &d))
        has[EXTENDED_C] = c;
}

/* The states of registers that the operating system keeps when it switches threads; 0 where it does not say. */
static uint64_t kept_states(const uint32_t has[REGISTERS]) {
    uint32_t low = 0, high = 0;
    if (!(has[ONE_C] & BIT(27))) /* OSXSAVE */
        return 0;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (uint64_t)high << 32 | low;
}

static bool has_level(const char *name) {
    uint32_t has[REGISTERS];
    size_t i = 0;
    while (i < sizeof levels / sizeof *levels && strcmp(levels[i].name, name) != 0)
        i++;
    if (i == sizeof levels / sizeof *levels)
        return false;
    read_registers(has);
    for (size_t k = 0; k < REGISTERS; k++)
        if ((has[k] & levels[i].needs[k]) != levels[i].needs[k])
            return false;
    return (kept_states(has) & levels[i].states) == levels[i].states;
}
#else
/* Other processors have one set of kernels, which needs no more than the rest of the library does. */
static bool has_level(const char *name) {
    (void)name;
    return true;
}
#endif

static const gscl_native_processor *forced;

bool gscl_native_processor_runs(const gscl_native_processor *processor) {
    return has_level(processor->name);
}

bool gscl_native_processor_force(const char *name) {
    forced = NULL;
    for (size_t i = 0; name && i < gscl_native_processor_count; i++)
        if (strcmp(gscl_native_processors[i].name, name) == 0 && gscl_native_processor_runs(&gscl_native_processors[i]))
            forced = &gscl_native_processors[i];
    return !name || forced;
}

const gscl_native_processor *gscl_native_processor_choose(void) {
    if (forced)
        return forced;
    for (size_t i = 0; i < gscl_native_processor_count; i++)
        if (gscl_native_processor_runs(&gscl_native_processors[i]))
            return &gscl_native_processors[i];
    return NULL;
}
