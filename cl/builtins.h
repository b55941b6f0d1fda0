/* The part of OpenCL C's header of built-in functions that the kernels use.
 *
 * PoCL 3 reads the whole of Clang's opencl-c.h, a megabyte, before each program, even if the program's kernels are in
 * its cache.  That takes most of the time of loading a program.  The build option -D_OPENCL_H_, the guard of that
 * header, keeps it out, and with -DGSCL_BUILTINS this file replaces it (host/lib/opencl/program.c).  Without that
 * option this file is empty. */
#ifdef GSCL_BUILTINS
#define MAXFLOAT 0x1.fffffep127f
#define as_int(x) __builtin_astype((x), int)
#define as_int4(x) __builtin_astype((x), int4)
#define as_int8(x) __builtin_astype((x), int8)
#define as_int16(x) __builtin_astype((x), int16)
#define as_float(x) __builtin_astype((x), float)
#define as_float4(x) __builtin_astype((x), float4)
#define as_float16(x) __builtin_astype((x), float16)

#define BUILTIN __attribute__((overloadable))
#define PURE __attribute__((overloadable, const))

PURE size_t get_global_id(uint dimension);
PURE size_t get_local_id(uint dimension);
PURE size_t get_local_size(uint dimension);
PURE size_t get_group_id(uint dimension);
BUILTIN __attribute__((convergent)) void barrier(uint fences);
BUILTIN int atomic_add(volatile __local int *number, int summand);

/* Functions of a floating-point type and of the integer type of its size. */
#define OF_FLOATS(real, integer)                   \
    PURE real atan2(real, real);                   \
    PURE real ceil(real);                          \
    PURE real exp(real);                           \
    PURE real exp2(real);                          \
    PURE real fabs(real);                          \
    PURE real floor(real);                         \
    PURE real log(real);                           \
    PURE real log2(real);                          \
    PURE real rint(real);                          \
    PURE real sign(real);                          \
    PURE real sqrt(real);                          \
    PURE real fma(real, real, real);               \
    PURE real fmax(real, real);                    \
    PURE real fmin(real, real);                    \
    PURE real clamp(real, real, real);             \
    PURE real pow(real, real);                     \
    PURE real native_exp2(real);                   \
    PURE integer clamp(integer, integer, integer); \
    PURE integer max(integer, integer);            \
    PURE integer min(integer, integer);            \
    PURE real select(real, real, integer);
OF_FLOATS(float, int)
OF_FLOATS(float4, int4)
OF_FLOATS(float16, int16)
#undef OF_FLOATS

#define OF_VECTORS(real, integer, n)     \
    PURE real clamp(real, float, float); \
    PURE int any(integer);               \
    PURE integer convert_int##n(real);   \
    PURE real convert_float##n(integer); \
    PURE uchar##n convert_uchar##n(real);
OF_VECTORS(float4, int4, 4)
OF_VECTORS(float16, int16, 16)
#undef OF_VECTORS
PURE int convert_int(float);
PURE float convert_float(int);
PURE float pown(float, int);

/* Loads and stores of whole vectors, in the address spaces where the kernels use them. */
#define OF_MEMORY(space, type, n)                         \
    BUILTIN type##n vload##n(size_t, const space type *); \
    BUILTIN void vstore##n(type##n, size_t, space type *);
OF_MEMORY(__global, float, 4)
OF_MEMORY(__global, float, 16)
OF_MEMORY(__global, int, 16)
OF_MEMORY(__global, uint, 8)
OF_MEMORY(__global, uchar, 16)
OF_MEMORY(__local, float, 4)
OF_MEMORY(__local, float, 16)
OF_MEMORY(__private, float, 4)
OF_MEMORY(__private, float, 8)
OF_MEMORY(__private, float, 16)
OF_MEMORY(__private, int, 4)
OF_MEMORY(__private, int, 16)
#undef OF_MEMORY
#undef BUILTIN
#undef PURE
#endif
