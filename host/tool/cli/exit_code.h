/* Exit codes of the program, beside EXIT_SUCCESS and EXIT_FAILURE of <stdlib.h>. */
#ifndef GSCL_TOOL_EXIT_CODE_H
#define GSCL_TOOL_EXIT_CODE_H

#define EXIT_USAGE 2    /* wrong command line */
#define EXIT_SOME 3     /* some of several images failed; the others are done */
#define EXIT_SIGNAL 128 /* plus the number of the signal that ended the program */

#endif
