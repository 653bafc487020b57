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

#define LANE(type, vector, lane) (((__private type *)&(vector))[lane])

static inline real lowest(reals x)
{
    real m = LANE(real, x, 0);
    for (int lane = 1; lane < LANES; lane++)
        m = LANE(real, x, lane) < m ? LANE(real, x, lane) : m;
    return m;
}
