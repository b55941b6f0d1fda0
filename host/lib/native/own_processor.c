/* Prints the name of the kernels that this processor runs: meson.build compiles and runs it for native_processors=own. */
#include <stdio.h>

#include "native/processor.h"

const gscl_native_processor gscl_native_processors[] = {{.name = "x86_64_v4"},
                                                        {.name = "x86_64_v3"},
                                                        {.name = "x86_64_v2"}};
const size_t gscl_native_processor_count = sizeof gscl_native_processors / sizeof *gscl_native_processors;

int main(void) {
    const gscl_native_processor *chosen = gscl_native_processor_choose();
    printf("%s", chosen ? chosen->name : "");
    return 0;
}
