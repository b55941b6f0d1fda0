#define _DEFAULT_SOURCE /* strcasecmp */
#include "commands/field_file.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/message.h"
#include "cli/names.h"
#include "cli/read_file.h"

#define MAX_FIELD_BYTES (UINT64_C(1) << 30) /* a million splats take 150 MB as text */
#define MAX_COLUMNS 64
#define MAX_NUMBER 64 /* characters */

/* ---- Columns ------------------------------------------------------------------------------------ */

/* The quantities of a splat that a column may have.  Shapes come in three forms. */
typedef enum column {
    X,
    Y,
    SIGMA1,
    SIGMA2,
    THETA,
    COVARIANCE_XX,
    COVARIANCE_XY,
    COVARIANCE_YY,
    CHOLESKY_11,
    CHOLESKY_21,
    CHOLESKY_22,
    OPACITY,
    RED,
    GREEN,
    BLUE,
    GREY,
    ALPHA,
    WAVE_X,
    WAVE_Y,
    WAVE_PHASE,
    WAVE_AMPLITUDE,
    LAYER,
    COLUMNS,
    NOT_USED = COLUMNS
} column;

static const struct {
    const char *name;
    column column;
} column_names[] = {{"x", X},
                    {"y", Y},
                    {"sigma1", SIGMA1},
                    {"sigma2", SIGMA2},
                    {"theta", THETA},
                    {"cov_xx", COVARIANCE_XX},
                    {"cov_xy", COVARIANCE_XY},
                    {"cov_yy", COVARIANCE_YY},
                    {"l11", CHOLESKY_11},
                    {"l21", CHOLESKY_21},
                    {"l22", CHOLESKY_22},
                    {"opacity", OPACITY},
                    {"weight", OPACITY},
                    {"red", RED},
                    {"green", GREEN},
                    {"blue", BLUE},
                    {"grey", GREY},
                    {"alpha", ALPHA},
                    {"wave_x", WAVE_X},
                    {"wave_y", WAVE_Y},
                    {"wave_phase", WAVE_PHASE},
                    {"wave_amplitude", WAVE_AMPLITUDE},
                    {"layer", LAYER}};

typedef enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE
} ply_type;

/* A table while it is read. */
typedef struct table {
    const char *label;    /* of the file, in messages */
    const char *at, *end; /* what comes next, and the end of it all */
    size_t line;          /* its number, from 1 on */
    size_t count;         /* of columns */
    column columns[MAX_COLUMNS];
    ply_type types[MAX_COLUMNS]; /* of a binary table */
    bool has[COLUMNS];
    size_t rows, capacity;
    gscl_field *field;
} table;

static bool add_column(table *t, const char *name, size_t length) {
    column found = NOT_USED;
    for (size_t i = 0; i < sizeof column_names / sizeof *column_names; i++)
        if (strlen(column_names[i].name) == length && strncasecmp(column_names[i].name, name, length) == 0)
            found = column_names[i].column;
    if (t->count == MAX_COLUMNS)
        return report_error(t->label, "line %zu: more than %d columns", t->line, MAX_COLUMNS);
    if (found != NOT_USED && t->has[found])
        return report_error(t->label, "line %zu: the column %.*s is there twice", t->line, (int)length, name);
    t->columns[t->count++] = found;
    if (found != NOT_USED)
        t->has[found] = true;
    return true;
}

static bool has_all(const table *t, column first, column last) {
    bool all = true;
    for (column c = first; c <= last; c = (column)(c + 1))
        all = all && t->has[c];
    return all;
}

static bool check_columns(const table *t) {
    if (!has_all(t, X, Y))
        return report_error(t->label, "has no columns x and y, the centre of a splat in pixels");
    if (!has_all(t, SIGMA1, SIGMA2) && !has_all(t, COVARIANCE_XX, COVARIANCE_YY) &&
        !has_all(t, CHOLESKY_11, CHOLESKY_22))
        return report_error(t->label,
                            "has no shape of a splat: columns sigma1 and sigma2 (and theta), or cov_xx, cov_xy and "
                            "cov_yy, or l11, l21 and l22");
    if (!has_all(t, RED, BLUE) && !t->has[GREY])
        return report_error(t->label, "has no colour of a splat: columns red, green and blue, or grey");
    return true;
}

/* ---- Rows --------------------------------------------------------------------------------------- */

static bool set_shape(const table *t, const double *value, gscl_splat *s) {
    double xx = value[COVARIANCE_XX], xy = value[COVARIANCE_XY], yy = value[COVARIANCE_YY];
    if (t->has[SIGMA1]) {
        s->sigma1 = (float)value[SIGMA1];
        s->sigma2 = (float)value[SIGMA2];
        s->theta = (float)value[THETA];
        return true;
    }
    if (t->has[CHOLESKY_11]) {
        const double a = value[CHOLESKY_11], b = value[CHOLESKY_21], c = value[CHOLESKY_22];
        xx = a * a, xy = a * b, yy = b * b + c * c;
    }
    if (gscl_splat_set_covariance(s, xx, xy, yy))
        return true;
    return report_error(
        t->label, "splat %zu: (%g, %g, %g) is no covariance of a Gaussian; it must be finite and positive definite",
        t->rows, xx, xy, yy);
}

static bool add_row(table *t, const double *value) {
    if (t->rows == t->capacity) {
        const size_t wanted = t->capacity ? 2 * t->capacity : 1024;
        gscl_splat *grown = t->rows < GSCL_MAX_SPLATS ? realloc(t->field->splats, wanted * sizeof *grown) : NULL;
        if (!grown)
            return t->rows < GSCL_MAX_SPLATS
                       ? report_error(t->label, "out of memory")
                       : report_error(t->label, "has more than %d splats, the most of the format", GSCL_MAX_SPLATS);
        t->field->splats = grown;
        t->capacity = wanted;
    }
    gscl_splat *s = &t->field->splats[t->rows];
    *s = (gscl_splat){.x = (float)value[X],
                      .y = (float)value[Y],
                      .opacity = t->has[OPACITY] ? (float)value[OPACITY] : 1.0f,
                      .wave_x = (float)value[WAVE_X],
                      .wave_y = (float)value[WAVE_Y],
                      .wave_phase = (float)value[WAVE_PHASE],
                      .wave_amplitude = (float)value[WAVE_AMPLITUDE],
                      .layer = value[LAYER] >= 0 && value[LAYER] < 256 ? (uint32_t)value[LAYER] : 256};
    for (int k = 0; k < 3; k++)
        s->colour[k] = (float)value[t->has[RED] ? RED + k : GREY];
    s->colour[3] = t->has[ALPHA] ? (float)value[ALPHA] : 1.0f;
    if (!set_shape(t, value, s))
        return false;
    t->rows++;
    return true;
}

/* ---- What else a comment says --------------------------------------------------------------------- */

/* Whether a text, which need not end with a zero byte, begins with a word. */
static bool starts_with(const char *text, const char *end, const char *word) {
    const size_t length = strlen(word);
    return (size_t)(end - text) >= length && memcmp(text, word, length) == 0;
}

bool field_parse_background(const char *text, float background[4]) {
    float value[4] = {0, 0, 0, 1};
    char *end;
    int count = 0;
    for (; count < 4; text = end + 1) {
        value[count++] = strtof(text, &end);
        if (end == text || (*end != ',' && *end != '\0' && *end != ' '))
            return false;
        if (*end != ',')
            break;
    }
    if (*end == ',' || count == 2)
        return false;
    if (count == 1)
        value[1] = value[2] = value[0];
    memcpy(background, value, sizeof value);
    return true;
}

static bool parse_steps(const char *text, gscl_field *field) {
    uint8_t *const steps[] = {&field->steps.scale,  &field->steps.position, &field->steps.angle,   &field->steps.luma,
                              &field->steps.chroma, &field->steps.alpha,    &field->steps.opacity, &field->steps.pivot};
    char *end;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++, text = end + 1) {
        const unsigned long value = strtoul(text, &end, 10);
        if (end == text || value > (i == 7 ? 63u : 15u) || (i < 7 && *end != ','))
            return false;
        *steps[i] = (uint8_t)value;
    }
    field->has_steps = true;
    return true;
}

static bool parse_blend(const char *text, gscl_field *field) {
    for (int i = GSCL_BLEND_NORMALIZED; blend_words[i]; i++) {
        const size_t length = strlen(blend_words[i]);
        if (strncmp(text, blend_words[i], length) == 0 && !isalpha((unsigned char)text[length])) {
            field->blend = (gscl_blend)i;
            return true;
        }
    }
    return false;
}

/* One word of the comment, "name=value"; words of other names mean nothing. */
static bool parse_word(const char *word, gscl_field *field) {
    if (strncmp(word, "width=", 6) == 0)
        field->width = (uint32_t)strtoul(word + 6, NULL, 10);
    else if (strncmp(word, "height=", 7) == 0)
        field->height = (uint32_t)strtoul(word + 7, NULL, 10);
    else if (strncmp(word, "channels=", 9) == 0)
        field->channels = (uint32_t)strtoul(word + 9, NULL, 10);
    else if (strncmp(word, "bits=", 5) == 0)
        field->sample = strtoul(word + 5, NULL, 10) > 8 ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8;
    else if (strncmp(word, "blend=", 6) == 0)
        return parse_blend(word + 6, field);
    else if (strncmp(word, "background=", 11) == 0)
        return field_parse_background(word + 11, field->background);
    else if (strncmp(word, "steps=", 6) == 0)
        return parse_steps(word + 6, field);
    else if (strcmp(word, "mean") == 0)
        field->has_mean_background = true;
    return true;
}

static bool parse_comment(table *t, const char *comment, size_t length) {
    char text[1024];
    if (length >= sizeof text || !starts_with(comment, comment + length, "gscl "))
        return true;
    memcpy(text, comment, length);
    text[length] = '\0';
    for (char *word = strtok(text + 5, " \t\r"); word; word = strtok(NULL, " \t\r"))
        if (!parse_word(word, t->field))
            return report_error(t->label, "line %zu: %.60s is not what gscl export writes there", t->line, word);
    return true;
}

/* ---- Text --------------------------------------------------------------------------------------- */

/* The next line without its end; false where there is none. */
static bool next_line(table *t, const char **line, size_t *length) {
    if (t->at == t->end)
        return false;
    const char *end = memchr(t->at, '\n', (size_t)(t->end - t->at));
    *line = t->at;
    *length = (size_t)((end ? end : t->end) - t->at);
    t->at = end ? end + 1 : t->end;
    t->line++;
    while (*length > 0 && isspace((unsigned char)(*line)[*length - 1]))
        --*length;
    return true;
}

/* The next word of a line, up to a separator; for ' ' any white space. */
static bool next_word(const char **at, const char *end, char separator, const char **word, size_t *length) {
    while (*at < end && (*at)[0] == ' ')
        ++*at;
    if (*at >= end)
        return false;
    *word = *at;
    while (*at < end && (separator == ' ' ? !isspace((unsigned char)**at) : **at != separator))
        ++*at;
    *length = (size_t)(*at - *word);
    if (*at < end)
        ++*at;
    while (*length > 0 && isspace((unsigned char)(*word)[*length - 1]))
        --*length;
    return true;
}

static bool parse_number(const table *t, const char *word, size_t length, double *value) {
    char text[MAX_NUMBER + 1], *end;
    const size_t kept = length < MAX_NUMBER ? length : MAX_NUMBER;
    memcpy(text, word, kept);
    text[kept] = '\0';
    *value = strtod(text, &end);
    return length > 0 && length <= MAX_NUMBER && *end == '\0'
               ? true
               : report_error(t->label, "line %zu: '%.40s' is no number", t->line, text);
}

static bool read_row(table *t, const char *line, size_t length, char separator) {
    double value[COLUMNS + 1] = {0};
    const char *at = line, *end = line + length, *word;
    size_t i = 0, size;
    for (; next_word(&at, end, separator, &word, &size); i++)
        if (i < t->count && t->columns[i] != NOT_USED && !parse_number(t, word, size, &value[t->columns[i]]))
            return false;
    if (i != t->count)
        return report_error(t->label, "line %zu: has %zu values; there are %zu columns", t->line, i, t->count);
    return add_row(t, value);
}

static bool read_csv(table *t) {
    const char *line, *word;
    size_t length, size;
    while (next_line(t, &line, &length)) {
        if (length == 0)
            continue;
        if (*line == '#') {
            const char *comment = line;
            while (comment < line + length && (*comment == '#' || *comment == ' '))
                comment++;
            if (!parse_comment(t, comment, (size_t)(line + length - comment)))
                return false;
        } else if (t->count > 0) {
            if (!read_row(t, line, length, ','))
                return false;
        } else {
            for (const char *at = line; next_word(&at, line + length, ',', &word, &size);)
                if (!add_column(t, word, size))
                    return false;
            if (!check_columns(t))
                return false;
        }
    }
    return t->count > 0 ? true : report_error(t->label, "has no line with the names of its columns");
}

/* ---- PLY ---------------------------------------------------------------------------------------- */

static bool parse_type(const char *word, size_t length, ply_type *type) {
    static const char *const names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                           {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                           {"float", "float32"}, {"double", "float64"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        for (int k = 0; k < 2; k++)
            if (strlen(names[i][k]) == length && strncmp(names[i][k], word, length) == 0) {
                *type = (ply_type)i;
                return true;
            }
    return false;
}

static uint64_t little_endian(const unsigned char *bytes, size_t size) {
    uint64_t value = 0;
    for (size_t i = 0; i < size; i++)
        value |= (uint64_t)bytes[i] << 8 * i;
    return value;
}

static size_t size_of_type(ply_type type) {
    static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

static double read_value(const unsigned char *bytes, ply_type type) {
    const uint64_t bits = little_endian(bytes, size_of_type(type));
    const uint32_t word = (uint32_t)bits;
    float single;
    double real;
    switch (type) {
    case PLY_INT8:
        return (double)(int)bits - (bits > 127 ? 256 : 0);
    case PLY_INT16:
        return (double)(int)bits - (bits > 32767 ? 65536 : 0);
    case PLY_INT32:
        return (double)bits - (bits > 2147483647 ? 4294967296.0 : 0);
    case PLY_FLOAT:
        memcpy(&single, &word, sizeof single);
        return single;
    case PLY_DOUBLE:
        memcpy(&real, &bits, sizeof real);
        return real;
    default:
        return (double)bits;
    }
}

static bool read_binary_rows(table *t, size_t rows) {
    size_t row_size = 0;
    for (size_t i = 0; i < t->count; i++)
        row_size += size_of_type(t->types[i]);
    if (row_size == 0 || (size_t)(t->end - t->at) / row_size < rows)
        return report_error(t->label, "is incomplete: %zu splats take %zu bytes each", rows, row_size);
    for (size_t row = 0; row < rows; row++) {
        double value[COLUMNS + 1] = {0};
        for (size_t i = 0; i < t->count; i++) {
            value[t->columns[i]] = read_value((const unsigned char *)t->at, t->types[i]);
            t->at += size_of_type(t->types[i]);
        }
        if (!add_row(t, value))
            return false;
    }
    return true;
}

static bool read_text_rows(table *t, size_t rows) {
    const char *line;
    size_t length;
    for (size_t row = 0; row < rows; row++) {
        if (!next_line(t, &line, &length))
            return report_error(t->label, "is incomplete: it has %zu of %zu splats", row, rows);
        if (!read_row(t, line, length, ' '))
            return false;
    }
    return true;
}

/* What the head of a PLY file says. */
typedef struct ply_head {
    bool is_binary, is_vertex; /* the properties that follow are those of splats */
    size_t rows;
} ply_head;

static bool refuse_head(const table *t, const char *line, size_t length) {
    return report_error(t->label,
                        "line %zu: '%.*s' is not understood; a PLY file of splats is ascii or binary_little_endian, "
                        "with the element vertex first, whose properties are numbers",
                        t->line, (int)(length < 60 ? length : 60), line);
}

static bool parse_property(table *t, const char *at, const char *line, size_t length) {
    const char *type, *name;
    size_t type_length, name_length;
    if (!next_word(&at, line + length, ' ', &type, &type_length) ||
        !next_word(&at, line + length, ' ', &name, &name_length) || t->count == MAX_COLUMNS ||
        !parse_type(type, type_length, &t->types[t->count]))
        return refuse_head(t, line, length);
    return add_column(t, name, name_length);
}

/* Digits alone. */
static bool parse_count(const char *word, size_t length, size_t *count) {
    *count = 0;
    for (size_t i = 0; i < length; i++) {
        if (!isdigit((unsigned char)word[i]) || *count > 100000000)
            return false;
        *count = 10 * *count + (size_t)(word[i] - '0');
    }
    return length > 0;
}

static bool parse_element(ply_head *head, const char *at, const char *end) {
    const char *word, *number;
    size_t length, digits;
    if (!next_word(&at, end, ' ', &word, &length) || !next_word(&at, end, ' ', &number, &digits))
        return false;
    const bool is_vertex = length == 6 && starts_with(word, end, "vertex");
    size_t rows;
    if (!parse_count(number, digits, &rows))
        return false;
    if (is_vertex)
        head->rows = rows;
    else if (!head->is_vertex && head->rows == 0)
        return false; /* its rows would come first */
    head->is_vertex = is_vertex;
    return true;
}

static bool parse_head_line(table *t, const char *line, size_t length, ply_head *head) {
    const char *at = line, *end = line + length, *word;
    size_t size;
    if (!next_word(&at, end, ' ', &word, &size))
        return true;
    if (size == 7 && starts_with(word, end, "comment"))
        return parse_comment(t, at, (size_t)(end - at));
    if (size == 8 && starts_with(word, end, "obj_info"))
        return true;
    if (size == 6 && starts_with(word, end, "format")) {
        head->is_binary = starts_with(at, end, "binary_little_endian");
        return head->is_binary || starts_with(at, end, "ascii") ? true : refuse_head(t, line, length);
    }
    if (size == 7 && starts_with(word, end, "element"))
        return parse_element(head, at, end) ? true : refuse_head(t, line, length);
    if (size == 8 && starts_with(word, end, "property"))
        return head->is_vertex ? parse_property(t, at, line, length) : true;
    return refuse_head(t, line, length);
}

static bool read_ply(table *t) {
    const char *line;
    size_t length;
    ply_head head = {0};
    next_line(t, &line, &length); /* "ply" */
    for (;;) {
        if (!next_line(t, &line, &length))
            return report_error(t->label, "is incomplete: its head does not end");
        if (length == 10 && starts_with(line, t->end, "end_header"))
            break;
        if (!parse_head_line(t, line, length, &head))
            return false;
    }
    if (!check_columns(t))
        return false;
    if (head.rows > GSCL_MAX_SPLATS)
        return report_error(t->label, "has %zu splats; the format has at most %d", head.rows, GSCL_MAX_SPLATS);
    return head.is_binary ? read_binary_rows(t, head.rows) : read_text_rows(t, head.rows);
}

/* ---- Files -------------------------------------------------------------------------------------- */

/* The splats of a gscl file. */
static bool read_coded(const char *label, const uint8_t *bytes, size_t size, gscl_field *field) {
    const gscl_result result = gscl_read_field(bytes, size, NULL, field);
    return result == GSCL_OK || report_error(label, "%s", gscl_result_text(result));
}

static bool read_table(const char *label, const char *text, size_t size, gscl_field *field) {
    table t = {.label = label, .end = text + size, .at = text, .field = field};
    const bool is_ply = size > 4 && memcmp(text, "ply", 3) == 0 && isspace((unsigned char)text[3]);
    const bool good = is_ply ? read_ply(&t) : read_csv(&t);
    field->count = t.rows;
    if (field->channels == 0)
        field->channels = (t.has[RED] ? 3 : 1) + t.has[ALPHA];
    return good;
}

bool field_parse(const char *label, const uint8_t *bytes, size_t size, gscl_field *field) {
    static const uint8_t magic[] = {0xC7, 0x67, 0x73};
    field->splats = NULL;
    const bool is_coded = size > sizeof magic && memcmp(bytes, magic, sizeof magic) == 0;
    if (is_coded ? read_coded(label, bytes, size, field) : read_table(label, (const char *)bytes, size, field))
        return true;
    gscl_free(field->splats);
    field->splats = NULL;
    return false;
}

bool field_read(const char *name, gscl_field *field) {
    uint8_t *bytes;
    size_t size;
    if (!read_file(name, MAX_FIELD_BYTES, &bytes, &size))
        return false;
    const bool good = field_parse(input_label(name), bytes, size, field);
    free(bytes);
    return good;
}
