// Polynomials in the pixel, moved from a record's centre to the middle of a tile. Moving is done in binary64; what
// is left to round in `real` afterwards is small offsets only.

typedef struct {
    real uu, uv, vv, u, v, one;
} quadratic;

typedef struct {
    real u, v, one;
} linear;

static inline quadratic move_quadratic(__global const double *c, double du, double dv)
{
    quadratic q;
    q.uu = (real)c[0];
    q.uv = (real)c[1];
    q.vv = (real)c[2];
    q.u = (real)(c[3] + 2.0 * c[0] * du + c[1] * dv);
    q.v = (real)(c[4] + 2.0 * c[2] * dv + c[1] * du);
    q.one = (real)(c[5] + (c[3] + c[0] * du + c[1] * dv) * du + (c[4] + c[2] * dv) * dv);
    return q;
}

static inline linear move_linear(__global const double *c, double du, double dv)
{
    return (linear){(real)c[0], (real)c[1], (real)(c[2] + c[0] * du + c[1] * dv)};
}

static inline reals at_quadratic(quadratic q, reals x, real y)
{
    return (q.uu * x + (q.uv * y + q.u)) * x + ((q.vv * y + q.v) * y + q.one);
}

static inline reals at_linear(linear l, reals x, real y) { return l.u * x + (l.v * y + l.one); }

// Upper bound over the square |x|, |y| <= h.
static inline real highest_quadratic(quadratic q, real h)
{
    real slope = fabs(q.u) + fabs(q.v);
    real bend = fabs(q.uv) + (q.uu > 0 ? q.uu : 0) + (q.vv > 0 ? q.vv : 0);
    return q.one + h * (slope + h * bend);
}
