#include "board.h"

#include <string.h>

/* By the linker (layout.ld). */
extern uint8_t data_begin[], data_end[], data_image[], bss_begin[], bss_end[], free_begin[], ram_end[];

int main(void);
void reset(void);
static void fault(void);

/* ---- Start ---- */

/* The stack pointer, and where the processor goes after a reset and at a fault. */
typedef struct vectors {
    const void *stack;
    void (*handlers[15])(void);
} vectors;

__attribute__((section(".vectors"), used)) static const vectors table = {
    ram_end,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault}};

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define COPROCESSOR_ACCESS REGISTER(0xE000ED88) /* CPACR */
#define FLOATING_POINT (0xFu << 20)             /* coprocessors 10 and 11 */

#define UNUSED 0xA5 /* fills the stack at the start */

/* Fills the stack below its own frame. */
void reset(void) {
    COPROCESSOR_ACCESS |= FLOATING_POINT;
    __asm volatile("dsb\n isb");
    memcpy(data_begin, data_image, (size_t)(data_end - data_begin));
    memset(bss_begin, 0, (size_t)(bss_end - bss_begin));
    const uint8_t *top = __builtin_frame_address(0);
    for (volatile uint8_t *at = ram_end - STACK_SIZE; at < top - 64; at++)
        *at = UNUSED;
    board_exit(main() == 0);
}

static void fault(void) {
    board_print("a fault of the processor\n");
    board_exit(false);
}

/* ---- Memory ---- */

size_t board_variables(void) {
    return (size_t)(free_begin - data_begin);
}

uint8_t *board_free_memory(size_t *size) {
    *size = (size_t)(ram_end - free_begin) - STACK_SIZE;
    return free_begin;
}

size_t board_used_stack(void) {
    const uint8_t *at = ram_end - STACK_SIZE;
    while (at < ram_end && *at == UNUSED)
        at++;
    return (size_t)(ram_end - at);
}

/* ---- Instructions: the timer of the processor, which counts down at 25 MHz ---- */

#define TIMER_CONTROL REGISTER(0xE000E010)
#define TIMER_RELOAD REGISTER(0xE000E014)
#define TIMER_VALUE REGISTER(0xE000E018)
#define TIMER_RUNS_AT_CLOCK 5u /* enabled, without interrupts */
#define TIMER_WRAPPED (1u << 16)
#define TIMER_LARGEST 0xFFFFFFu
#define INSTRUCTIONS_PER_TICK 40u

void board_start_count(void) {
    TIMER_RELOAD = TIMER_LARGEST;
    TIMER_VALUE = 0;
    TIMER_CONTROL = TIMER_RUNS_AT_CLOCK;
    while (TIMER_VALUE == 0) /* until the first tick loads it */
        ;
    (void)TIMER_CONTROL; /* reading clears TIMER_WRAPPED */
}

uint32_t board_count(void) {
    const uint32_t ticks = TIMER_LARGEST - TIMER_VALUE;
    if (TIMER_CONTROL & TIMER_WRAPPED) {
        board_print("the timer wrapped\n");
        board_exit(false);
    }
    return ticks * INSTRUCTIONS_PER_TICK;
}

/* ---- Semihosting: calls of the emulator ---- */

enum { SYS_OPEN = 0x01, SYS_WRITE0 = 0x04, SYS_WRITE = 0x05, SYS_READ = 0x06, SYS_GET_CMDLINE = 0x15, SYS_EXIT = 0x20 };
enum { READ_BINARY = 1, WRITE_BINARY = 5 };     /* modes of SYS_OPEN */
#define STOPPED_BY_PROGRAM ((uintptr_t)0x20026) /* reason of SYS_EXIT */

static intptr_t call(uintptr_t operation, const void *parameters) {
    register uintptr_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = parameters;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return (intptr_t)r0;
}

void board_exit(bool success) {
    const uintptr_t parameters[] = {STOPPED_BY_PROGRAM, success ? 0 : 1};
    call(SYS_EXIT, parameters);
    for (;;)
        ;
}

void board_print(const char *text) {
    call(SYS_WRITE0, text);
}

void board_print_number(const char *name, uint32_t number) {
    char digits[12] = {0};
    size_t at = sizeof digits - 2;
    digits[at] = '\n';
    do
        digits[--at] = (char)('0' + number % 10);
    while ((number /= 10) > 0);
    board_print(name);
    board_print(" ");
    board_print(digits + at);
}

static int open_file(const char *path, uintptr_t mode) {
    const uintptr_t parameters[] = {(uintptr_t)path, mode, strlen(path)};
    const int file = (int)call(SYS_OPEN, parameters);
    if (file < 0) {
        board_print("a file cannot be opened\n");
        board_exit(false);
    }
    return file;
}

size_t board_read(const char *path, void *bytes, size_t size) {
    const uintptr_t parameters[] = {(uintptr_t)open_file(path, READ_BINARY), (uintptr_t)bytes, size};
    return size - (size_t)call(SYS_READ, parameters); /* it returns the bytes that were not read */
}

int board_create(const char *path) {
    return open_file(path, WRITE_BINARY);
}

void board_write(int file, const void *bytes, size_t size) {
    const uintptr_t parameters[] = {(uintptr_t)file, (uintptr_t)bytes, size};
    if (call(SYS_WRITE, parameters) != 0) {
        board_print("a file cannot be written\n");
        board_exit(false);
    }
}

int board_words(const char **words, int most) {
    static char line[256];
    uintptr_t parameters[] = {(uintptr_t)line, sizeof line};
    int count = 0;
    bool is_inside = false;
    call(SYS_GET_CMDLINE, parameters);
    for (char *at = line; *at; at++) {
        if (*at != ' ' && !is_inside && count < most)
            words[count++] = at;
        is_inside = *at != ' ';
        if (!is_inside)
            *at = 0;
    }
    return count;
}
