/* Elementary functions by JavaScript's Math, which engines call as quickly as their own functions.  Those of the library have
 * the same bits on every machine, which only an encoder needs, but they would not fit into so small a module. */
#include "runtime/elementary.h"

#include <math.h>

/* Names of their own, because the linker would replace those of the C library. */
#define FROM_JAVASCRIPT(name) __attribute__((import_module("Math"), import_name(name)))
FROM_JAVASCRIPT("exp") double math_exp(double x);
FROM_JAVASCRIPT("log") double math_log(double x);
FROM_JAVASCRIPT("pow") double math_pow(double x, double y);
FROM_JAVASCRIPT("cos") double math_cos(double x);
FROM_JAVASCRIPT("sin") double math_sin(double x);
FROM_JAVASCRIPT("tan") double math_tan(double x);
FROM_JAVASCRIPT("atan2") double math_atan2(double y, double x);

double gscl_exp(double x) {
    return math_exp(x);
}

double gscl_exp2(double x) {
    return math_pow(2, x);
}

double gscl_ln(double x) {
    return math_log(x);
}

double gscl_log2(double x) {
    return math_log(x) / math_log(2);
}

double gscl_cos(double x) {
    return math_cos(x);
}

double gscl_sin(double x) {
    return math_sin(x);
}

double gscl_tan(double x) {
    return math_tan(x);
}

double gscl_atan2(double y, double x) {
    return math_atan2(y, x);
}

double gscl_hypot(double x, double y) {
    return sqrt(x * x + y * y);
}
