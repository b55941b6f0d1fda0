/* Whether the loader of the C library takes a module of Python: load_module FILE SYMBOL.  What Python has is bound when it is
 * called, and never is. */
#include <dlfcn.h>
#include <stdio.h>

int main(int count, char **arguments) {
    void *module = count == 3 ? dlopen(arguments[1], RTLD_LAZY) : NULL;
    if (!module || !dlsym(module, arguments[2])) {
        fprintf(stderr, "%s\n", count == 3 ? dlerror() : "load_module FILE SYMBOL");
        return 1;
    }
    printf("loaded %s\n", arguments[2]);
    return 0;
}
