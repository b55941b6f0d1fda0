#define _POSIX_C_SOURCE 200809L /* read */
#include "commands/input_list.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/message.h"
#include "cli/read_file.h"
#include "host/system/files.h"

#define BUFFER_SIZE ((size_t)64 << 10)

bool input_list_open(input_list *list, char *const *operands, int operand_count, const char *list_name, bool null) {
    system_status status;
    *list = (input_list){.operands = operands,
                         .operand_count = operand_count,
                         .file = -1,
                         .can_restart = true,
                         .delimiter = null ? '\0' : '\n'};
    if (!list_name)
        return true;
    list->label = input_label(list_name);
    list->file = strcmp(list_name, "-") == 0 ? STDIN_FILENO : system_open_to_read(list_name);
    if (list->file < 0)
        return report_error(list->label, "cannot be opened: %s", system_error_text(errno));
    list->can_restart = list->file != STDIN_FILENO && system_status_of_open(list->file, &status) && status.is_regular;
    list->buffer = malloc(BUFFER_SIZE);
    return list->buffer || report_error(list->label, "%s", system_error_text(ENOMEM));
}

void input_list_close(input_list *list) {
    free(list->buffer);
    list->buffer = NULL;
    if (list->file > STDIN_FILENO)
        close(list->file);
    list->file = -1;
}

void input_list_wait(const input_list *list, int milliseconds) {
    system_has_input(list->file, milliseconds);
}

/* Fills the buffer, without waiting for the writer. */
static input_state fill_buffer(input_list *list) {
    if (!system_has_input(list->file, 0))
        return INPUT_WAIT;
    const ssize_t count = read(list->file, list->buffer, BUFFER_SIZE);
    if (count < 0 && (errno == EINTR || errno == EAGAIN))
        return INPUT_WAIT;
    if (count < 0) {
        report_error(list->label, "cannot be read: %s", system_error_text(errno));
        return INPUT_ERROR;
    }
    list->begin = 0;
    list->end = (size_t)count;
    return count > 0 ? INPUT_NAME : INPUT_END;
}

static void add_byte(input_list *list, char byte) {
    if (list->length < INPUT_NAME_SIZE - 1)
        list->name[list->length] = byte;
    list->has_nul = list->has_nul || byte == '\0';
    list->length++;
}

/* Ends the name that has been read.  Returns false when it is empty. */
static bool end_name(input_list *list, const char **name, const char **problem) {
    const size_t length = list->length;
    const bool has_nul = list->has_nul;
    list->name[length < INPUT_NAME_SIZE ? length : INPUT_NAME_SIZE - 1] = '\0';
    list->length = 0;
    list->has_nul = false;
    *name = list->name;
    if (has_nul)
        *problem = "is a name in the list with a NUL in it; with --null a NUL ends each name";
    else if (length >= INPUT_NAME_SIZE)
        *problem = "is the start of a name in the list that is longer than 4095 bytes";
    else if (strcmp(list->name, "-") == 0)
        *problem = "cannot be standard input in a list; ./- is the file of this name";
    return length > 0;
}

static input_state next_of_list(input_list *list, const char **name, const char **problem) {
    while (!list->is_ended) {
        const input_state state = list->begin < list->end ? INPUT_NAME : fill_buffer(list);
        if (state == INPUT_WAIT || state == INPUT_ERROR)
            return state;
        list->is_ended = state == INPUT_END; /* the last name may lack its delimiter */
        while (list->begin < list->end && list->buffer[list->begin] != list->delimiter)
            add_byte(list, list->buffer[list->begin++]);
        const bool is_whole = list->is_ended || list->begin < list->end;
        list->begin++;
        if (is_whole && end_name(list, name, problem))
            return INPUT_NAME;
    }
    return INPUT_END;
}

input_state input_list_next(input_list *list, const char **name, const char **problem) {
    *problem = NULL;
    if (list->next_operand == list->operand_count)
        return list->file < 0 ? INPUT_END : next_of_list(list, name, problem);
    *name = list->operands[list->next_operand++];
    return INPUT_NAME;
}
