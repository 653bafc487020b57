// The vectors that casting is written in: LANES pixels of one row, binary64 or binary32.
//
// PoCL does not vectorise a kernel with a loop in it, so the vectors are explicit; only operators and sqrt are used
// in hot loops, because PoCL 3.0 calls its other built-ins instead of inlining them.

#ifndef REAL_BITS
#error "define REAL_BITS as 64 or 32"
#endif
#ifndef LANES
#error "define LANES as 4, 8 or 16"
#endif

// EXACT: every decision and every rounding carries a rigorous error bound; pixels in doubt are listed for the host.
#ifndef EXACT
#error "define EXACT as 0 or 1"
#endif
#if EXACT && REAL_BITS != 64
#error "EXACT casts in binary64"
#endif

// EXACT lets the compiler fuse products and sums: its bounds count both roundings, and what it writes is certified.
#if EXACT
#pragma OPENCL FP_CONTRACT ON
#endif

#define JOIN2(a, b) a##b
#define JOIN(a, b) JOIN2(a, b)
#if REAL_BITS == 64
typedef double real;
typedef long integer;
typedef JOIN(double, LANES) reals;
typedef JOIN(long, LANES) mask;     // also winners: as wide as the comparison results
#elif REAL_BITS == 32
typedef float real;
typedef int integer;
typedef JOIN(float, LANES) reals;
typedef JOIN(int, LANES) mask;
#else
#error "REAL_BITS is 64 or 32"
#endif
typedef JOIN(float, LANES) floats;
#if REAL_BITS == 64
#define TO_FLOATS(v) __builtin_convertvector(v, floats)
#define FROM_FLOATS(v) __builtin_convertvector(v, reals)
#else
#define TO_FLOATS(v) (v)
#define FROM_FLOATS(v) (v)
#endif

// OR-folding halves is twice as fast as any(), which PoCL expands lane by lane.
#if REAL_BITS == 32
#if LANES == 16
#define HALVES(m) as_long8(m)
#define FOLD8
#elif LANES == 8
#define HALVES(m) as_long4(m)
#else
#error "binary32 takes 8 or 16 lanes"
#endif
#else
#define HALVES(m) (m)
#if LANES == 8
#define FOLD8
#endif
#endif

// store_tile reads tiles of binary32 in wider vectors.
#define ALIGNED __attribute__((aligned(64)))

// The cells of LANES pixels that a tile is cast in.
#define VECTORS (TILE / LANES)          // per row
#define CELLS (TILE * VECTORS)          // per tile
#define MISS ((integer)-1)              // winner of a pixel that nothing hits

static inline int some(mask m)
{
#ifdef FOLD8
    long8 a = HALVES(m);
    long4 b = a.lo | a.hi;
#else
    long4 b = HALVES(m);
#endif
    long2 c = b.lo | b.hi;
    return (c.x | c.y) != 0;
}

// |x| as an operator: fabs is one of the calls.
static inline reals magnitude(reals x)
{
#if REAL_BITS == 64
    return JOIN(as_double, LANES)(JOIN(as_long, LANES)(x) & 0x7fffffffffffffffL);
#else
    return JOIN(as_float, LANES)(JOIN(as_int, LANES)(x) & 0x7fffffff);
#endif
}

#define LANE(type, vector, lane) (((__private type *)&(vector))[lane])

static inline real lowest(reals x)
{
    real m = LANE(real, x, 0);
    for (int lane = 1; lane < LANES; lane++)
        m = LANE(real, x, lane) < m ? LANE(real, x, lane) : m;
    return m;
}
