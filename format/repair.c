#include "format/repair.h"

#include <string.h>

#include "format/container.h"
#include "format/packet.h"

/* ---- The field with 256 elements ---- */

static uint8_t multiply(uint8_t a, uint8_t b) {
    unsigned product = 0;
    for (unsigned i = 0; i < 8; i++)
        product ^= b >> i & 1 ? (unsigned)a << i : 0;
    for (unsigned i = 14; i >= 8; i--)
        product ^= product >> i & 1 ? 0x11Du << (i - 8) : 0;
    return (uint8_t)product;
}

/* a^254 */
static uint8_t inverse(uint8_t a) {
    uint8_t power = a;
    for (unsigned i = 0; i < 6; i++)
        power = multiply(multiply(power, power), a);
    return multiply(power, power);
}

/* What a packet counts for in a repair packet. */
static uint8_t coefficient(uint32_t repair, uint32_t packet) {
    return inverse((uint8_t)(repair ^ packet));
}

/* to[i] += factor * from[i] */
static void add_multiple(uint8_t *to, const uint8_t *from, size_t size, uint8_t factor) {
    uint8_t low[16], high[16];
    for (unsigned i = 0; i < 16; i++) {
        low[i] = multiply((uint8_t)i, factor);
        high[i] = multiply((uint8_t)(i << 4), factor);
    }
    for (size_t i = 0; i < size; i++)
        to[i] ^= (uint8_t)(low[from[i] & 15] ^ high[from[i] >> 4]);
}

/* ---- Writing ---- */

void gsf_write_repair(const gsf_bytes *packets, uint32_t count, size_t longest, uint32_t number, uint8_t *repair) {
    const size_t content = longest - 1;
    repair[0] = packets[0].data[0];
    repair[1] = (uint8_t)number;
    memset(repair + 2, 0, content);
    for (uint32_t i = 0; i < count; i++)
        add_multiple(repair + 2, packets[i].data + 1, packets[i].size - 1, coefficient(number, i));
    gsf_put_check(repair, 2 + content, GSF_REPAIR_MASK);
}

/* ---- Reading ---- */

bool gsf_open_repair(gsf_bytes packet, uint8_t *identity, uint32_t *number) {
    if (packet.size <= GSF_REPAIR_FRAME || packet.data[0] == GSF_NO_IDENTITY)
        return false;
    *identity = packet.data[0];
    *number = packet.data[1];
    return gsf_has_check(packet.data, packet.size, GSF_REPAIR_MASK);
}

/* The packets of a list's picture and what could replace those that it lacks. */
typedef struct repair_task {
    gsf_bytes packets[GSF_MAX_PACKETS]; /* by number; data is NULL where one is missing */
    uint32_t missing[GSF_MAX_PACKETS];  /* their numbers */
    gsf_bytes repairs[GSF_MAX_PACKETS]; /* the contents of repair packets, as many as are missing at most */
    uint8_t numbers[GSF_MAX_PACKETS];   /* of repair packets */
    uint32_t count, missing_count, repair_count;
    size_t size; /* of a content */
    uint8_t identity;
} repair_task;

static bool has_repair(const repair_task *t, uint32_t number) {
    bool found = false;
    for (uint32_t i = 0; i < t->repair_count; i++)
        found = found || t->numbers[i] == number;
    return found;
}

static void note_repair(repair_task *t, gsf_bytes packet) {
    uint8_t identity;
    uint32_t number;
    if (!gsf_open_repair(packet, &identity, &number) || identity != t->identity || number < t->count ||
        t->repair_count == t->missing_count || has_repair(t, number))
        return;
    const gsf_bytes content = {packet.data + 2, packet.size - GSF_REPAIR_FRAME};
    if (t->repair_count > 0 && content.size != t->size)
        return;
    t->size = content.size;
    t->numbers[t->repair_count] = (uint8_t)number;
    t->repairs[t->repair_count++] = content;
}

static void find_missing(repair_task *t) {
    for (uint32_t i = 0; i < t->count; i++)
        if (!t->packets[i].data)
            t->missing[t->missing_count++] = i;
}

/* Whether each packet fits into the contents of the repair packets. */
static bool sizes_fit(const repair_task *t) {
    bool fits = true;
    for (uint32_t i = 0; i < t->count; i++)
        fits = fits && (!t->packets[i].data || t->packets[i].size - 1 <= t->size);
    return fits;
}

/* Finds what a list has.  Returns whether what it lacks can be computed. */
static bool prepare(const uint8_t *list, size_t size, repair_task *t) {
    gsf_bytes packet;
    size_t position = 0;
    *t = (repair_task){.count = 0};
    t->count = gsf_list_packets(list, size, t->packets, &t->identity);
    find_missing(t);
    while (t->missing_count > 0 && gsf_next_packet(list, size, &position, &packet))
        note_repair(t, packet);
    return t->missing_count > 0 && t->repair_count == t->missing_count && sizes_fit(t);
}

/* Working memory: for each missing packet a row of the equations, with its content behind it. */
static size_t row_size(const repair_task *t) {
    return t->missing_count + t->size;
}

size_t gsf_repair_size(const uint8_t *list, size_t size) {
    repair_task t;
    if (!prepare(list, size, &t))
        return 0;
    /* A packet in a list is shorter than its row and the field of its size. */
    return t.missing_count * (row_size(&t) + 1 + gsf_packet_size_field(GSF_MAX_PACKET_SIZE)) + row_size(&t);
}

/* The equations of the missing packets: row i says what repair packet i has of them. */
static void make_equations(const repair_task *t, uint8_t *rows) {
    const uint32_t n = t->missing_count;
    for (uint32_t i = 0; i < n; i++) {
        uint8_t *row = rows + i * row_size(t);
        for (uint32_t j = 0; j < n; j++)
            row[j] = coefficient(t->numbers[i], t->missing[j]);
        memcpy(row + n, t->repairs[i].data, t->size);
        for (uint32_t j = 0; j < t->count; j++)
            if (t->packets[j].data)
                add_multiple(row + n, t->packets[j].data + 1, t->packets[j].size - 1, coefficient(t->numbers[i], j));
    }
}

/* Solves them: row i becomes missing packet i.  In a Cauchy matrix no pivot is 0, whatever the order. */
static void solve(const repair_task *t, uint8_t *rows) {
    const uint32_t n = t->missing_count;
    const size_t length = row_size(t);
    for (uint32_t i = 0; i < n; i++) {
        uint8_t *pivot = rows + i * length;
        const uint8_t factor = inverse(pivot[i]);
        for (size_t j = 0; j < length; j++)
            pivot[j] = multiply(pivot[j], factor);
        for (uint32_t k = 0; k < n; k++)
            if (k != i)
                add_multiple(rows + k * length, pivot, length, rows[k * length + i]);
    }
}

/* The bytes of a packet whose content is known, behind which there are zeros: the fewest with a matching check.  0: none. */
static size_t packet_size(uint8_t *packet, size_t longest) {
    uint8_t identity;
    gsf_bytes picture;
    size_t size = longest;
    while (size > 0 && packet[size - 1] == 0)
        size--;
    while (size <= longest && gsf_open_packet((gsf_bytes){packet, size}, &identity, &picture) != GSF_OK)
        size++;
    return size <= longest ? size : 0;
}

size_t gsf_repair_list(const uint8_t *list, size_t size, uint8_t *memory) {
    repair_task t;
    size_t written = 0;
    if (!prepare(list, size, &t))
        return 0;
    const size_t fields = t.missing_count * (1 + gsf_packet_size_field(GSF_MAX_PACKET_SIZE));
    uint8_t *rows = memory + row_size(&t) + fields; /* what is written never reaches a row that is still needed */
    make_equations(&t, rows);
    solve(&t, rows);
    for (uint32_t i = 0; i < t.missing_count; i++) {
        uint8_t *packet = rows + i * row_size(&t) + t.missing_count - 1; /* the identity comes before the content */
        packet[0] = t.identity;
        const size_t found = packet_size(packet, t.size + 1);
        if (found == 0)
            continue;
        gsf_put_packet_size(memory + written, found);
        written += gsf_packet_size_field(found);
        memmove(memory + written, packet, found);
        written += found;
    }
    return written;
}
