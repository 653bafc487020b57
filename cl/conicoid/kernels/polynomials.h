// Polynomials in the pixel, moved from a record's centre to the middle of a tile. Moving is done in binary64; what
// is left to round in `real` afterwards is small offsets only.

//
// `error` bounds |computed - exact| anywhere on the tile. In the expanded polynomial no term passes through more than
// 14 roundings (1 when its coefficient was stored, 7 in moving, 6 in evaluation), so 15u times the sum of the terms'
// magnitudes at the far corner holds, u = 2^-53 (Higham 2002, section 3.1); what set-up lost is added by the caller.

typedef struct {
    real uu, uv, vv, u, v, one, error;
} quadratic;

typedef struct {
    real u, v, one, error;
} linear;

#define CHAIN (15.0 * UNIT_ROUNDOFF)

static inline quadratic move_quadratic(__global const double *c, double du, double dv)
{
    quadratic q;
    q.uu = (real)c[0];
    q.uv = (real)c[1];
    q.vv = (real)c[2];
    q.u = (real)(c[3] + 2.0 * c[0] * du + c[1] * dv);
    q.v = (real)(c[4] + 2.0 * c[2] * dv + c[1] * du);
    q.one = (real)(c[5] + (c[3] + c[0] * du + c[1] * dv) * du + (c[4] + c[2] * dv) * dv);
#if EXACT
    double x = fabs(du) + TILE / 2, y = fabs(dv) + TILE / 2;
    q.error = CHAIN * (fabs(c[5]) + (fabs(c[3]) + fabs(c[0]) * x + fabs(c[1]) * y) * x + (fabs(c[4]) + fabs(c[2]) * y) * y);
#endif
    return q;
}

static inline linear move_linear(__global const double *c, double du, double dv)
{
    linear l;
    l.u = (real)c[0];
    l.v = (real)c[1];
    l.one = (real)(c[2] + c[0] * du + c[1] * dv);
#if EXACT
    l.error = CHAIN * (fabs(c[2]) + fabs(c[0]) * (fabs(du) + TILE / 2) + fabs(c[1]) * (fabs(dv) + TILE / 2));
#endif
    return l;
}

static inline reals at_quadratic(quadratic q, reals x, real y)
{
    return (q.uu * x + (q.uv * y + q.u)) * x + ((q.vv * y + q.v) * y + q.one);
}

static inline reals at_linear(linear l, reals x, real y) { return l.u * x + (l.v * y + l.one); }

// Simple records are evaluated about their own centres in binary64: nothing is rounded by moving them. Binary32 wants the
// small offsets about the tile's middle, (du, dv) from the centre.
#if REAL_BITS == 64
#define LOCAL(offset) (offset)

static inline quadratic local_quadratic(__global const double *c, double du, double dv)
{
    return (quadratic){c[0], c[1], c[2], c[3], c[4], c[5]};
}

static inline linear local_linear(__global const double *c, double du, double dv)
{
    return (linear){c[0], c[1], c[2]};
}
#else
#define LOCAL(offset) 0
#define local_quadratic move_quadratic
#define local_linear move_linear
#endif

// Value at the far corner of a linear form of magnitudes.
static inline double norm_at(__global const double *c, double du, double dv)
{
    return c[2] + c[0] * (fabs(du) + TILE / 2) + c[1] * (fabs(dv) + TILE / 2);
}

// Upper bound over the square |x|, |y| <= h.
static inline real highest_quadratic(quadratic q, real h)
{
    real slope = fabs(q.u) + fabs(q.v);
    real bend = fabs(q.uv) + (q.uu > 0 ? q.uu : 0) + (q.vv > 0 ? q.vv : 0);
    return q.one + h * (slope + h * bend);
}
