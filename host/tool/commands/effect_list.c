#include "commands/effect_list.h"

#include <stdio.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/message.h"

/* The effect of this name, or 0. */
static uint32_t effect_named(const char *name, size_t length) {
    for (unsigned bit = 0; bit < GSCL_EFFECT_COUNT; bit++) {
        const char *candidate = gscl_effect_name((gscl_effect)(1u << bit));
        if (candidate && strlen(candidate) == length && strncmp(candidate, name, length) == 0)
            return 1u << bit;
    }
    return 0;
}

/* Appends " NAME" for each effect, separated by commas. */
static void list_effects(char *text, size_t capacity) {
    for (unsigned bit = 0; bit < GSCL_MAX_EFFECTS; bit++) {
        const char *name = gscl_effect_name((gscl_effect)(1u << bit));
        const size_t used = strlen(text);
        if (name)
            snprintf(text + used, capacity - used, "%s %s", used ? "," : "", name);
    }
}

static bool report_wrong_effect(const char *text, size_t length) {
    char names[256] = "";
    list_effects(names, sizeof names);
    report_usage("encode", "--effects: '%.*s' is not + or - with one of%s", (int)length, text, names);
    return false;
}

bool effect_list_parse(const char *text, uint32_t *on, uint32_t *off) {
    *on = *off = 0;
    while (text) {
        const size_t length = strcspn(text, ",");
        const uint32_t effect = length > 1 ? effect_named(text + 1, length - 1) : 0;
        if (!effect || (*text != '+' && *text != '-'))
            return report_wrong_effect(text, length);
        *(*text == '+' ? on : off) |= effect;
        text = text[length] ? text + length + 1 : NULL;
    }
    return true;
}
