/* Whether the C library has all that a module needs of it: load_module FILE SYMBOL. */
#include <dlfcn.h>
#include <stdio.h>

int main(int count, char **arguments) {
    void *module = count == 3 ? dlopen(arguments[1], RTLD_NOW) : NULL;
    if (!module || !dlsym(module, arguments[2])) {
        fprintf(stderr, "%s\n", count == 3 ? dlerror() : "load_module FILE SYMBOL");
        return 1;
    }
    printf("loaded %s\n", arguments[2]);
    return 0;
}
