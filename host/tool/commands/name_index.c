#include "commands/name_index.h"

#include <unistd.h>

#include "host/system/files.h"

#define FIRST_CAPACITY 1024 /* slots; a power of two, as all later ones */
#define SLOTS_READ 256      /* at a time, when all are read */

/* A file of empty slots.  Returns -1 with errno. */
static int make_table(uint64_t capacity) {
    const int file = system_make_scratch();
    if (file < 0 || system_set_size(file, capacity * sizeof(name_entry)))
        return file;
    close(file);
    return -1;
}

bool name_index_create(name_index *index) {
    *index = (name_index){.file = make_table(FIRST_CAPACITY), .capacity = FIRST_CAPACITY};
    return index->file >= 0;
}

void name_index_free(name_index *index) {
    if (index->file >= 0)
        close(index->file);
    index->file = -1;
}

static bool read_slots(int file, uint64_t slot, name_entry *entries, size_t count) {
    return system_read_at(file, entries, count * sizeof *entries, slot * sizeof *entries);
}

static bool write_slot(int file, uint64_t slot, const name_entry *entry) {
    return system_write_at(file, entry, sizeof *entry, slot * sizeof *entry);
}

/* The slot that has the key, or the empty one where it belongs.  At least half of the slots are empty. */
static bool find_slot(const name_index *index, const uint64_t key[2], uint64_t *slot, name_entry *entry) {
    for (uint64_t at = key[0];; at++) {
        *slot = at & (index->capacity - 1);
        if (!read_slots(index->file, *slot, entry, 1))
            return false;
        if (entry->state == 0 || (entry->key[0] == key[0] && entry->key[1] == key[1]))
            return true;
    }
}

bool name_index_get(const name_index *index, const uint64_t key[2], name_entry *entry) {
    uint64_t slot;
    return find_slot(index, key, &slot, entry);
}

static bool copy_entries(const name_index *from, name_index *to) {
    name_entry entries[SLOTS_READ];
    for (uint64_t slot = 0; slot < from->capacity; slot += SLOTS_READ) {
        if (!read_slots(from->file, slot, entries, SLOTS_READ))
            return false;
        for (int i = 0; i < SLOTS_READ; i++)
            if (entries[i].state != 0 && !name_index_put(to, &entries[i]))
                return false;
    }
    return true;
}

static bool double_table(name_index *index) {
    name_index larger = {.file = make_table(2 * index->capacity), .capacity = 2 * index->capacity};
    if (larger.file < 0)
        return false;
    if (!copy_entries(index, &larger)) {
        name_index_free(&larger);
        return false;
    }
    name_index_free(index);
    *index = larger;
    return true;
}

bool name_index_put(name_index *index, const name_entry *entry) {
    name_entry found;
    uint64_t slot;
    if (!find_slot(index, entry->key, &slot, &found))
        return false;
    if (found.state == 0 && 2 * (index->count + 1) > index->capacity)
        return double_table(index) && name_index_put(index, entry);
    if (!write_slot(index->file, slot, entry))
        return false;
    index->count += found.state == 0;
    return true;
}
