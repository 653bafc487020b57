// Double-double arithmetic on double4: four quadrics at a time.
//
// u = 2^-53. Needs round-to-nearest, a true fma and no contraction or re-association. Relative error bounds from
// Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic"
// (ACM TOMS 44(2), 2017): dd + dd 3u^2 + 13u^3, dd x dd 5u^2, dd / dd 9.8u^2.

typedef struct {
    double4 hi;
    double4 lo;
} dd;

static inline dd dd_from(double4 a) { return (dd){a, (double4)(0.0)}; }

static inline dd dd_scalar(__global const double *pair) { return (dd){(double4)(pair[0]), (double4)(pair[1])}; }

// |a| >= |b|, or a = 0: exact.
static inline dd quick_two_sum(double4 a, double4 b)
{
    double4 s = a + b;
    double4 z = s - a;
    return (dd){s, b - z};
}

// Exact.
static inline dd two_sum(double4 a, double4 b)
{
    double4 s = a + b;
    double4 z = s - a;
    double4 w = s - z;
    double4 x = a - w;
    double4 y = b - z;
    return (dd){s, x + y};
}

// Exact away from underflow.
static inline dd two_product(double4 a, double4 b)
{
    double4 p = a * b;
    return (dd){p, fma(a, b, -p)};
}

static inline dd dd_neg(dd a) { return (dd){-a.hi, -a.lo}; }

static inline dd dd_add(dd a, dd b)
{
    dd s = two_sum(a.hi, b.hi);
    dd t = two_sum(a.lo, b.lo);
    double4 c = s.lo + t.hi;
    dd v = quick_two_sum(s.hi, c);
    double4 w = t.lo + v.lo;
    return quick_two_sum(v.hi, w);
}

static inline dd dd_sub(dd a, dd b) { return dd_add(a, dd_neg(b)); }

static inline dd dd_mul(dd a, dd b)
{
    dd p = two_product(a.hi, b.hi);
    double4 t = a.lo * b.lo;
    t = fma(a.hi, b.lo, t);
    t = fma(a.lo, b.hi, t);
    return quick_two_sum(p.hi, p.lo + t);
}

static inline dd dd_scale(dd a, double4 b)
{
    dd p = two_product(a.hi, b);
    return quick_two_sum(p.hi, fma(a.lo, b, p.lo));
}

static inline dd dd_div(dd a, dd b)
{
    double4 q = a.hi / b.hi;
    dd r = dd_sub(a, dd_scale(b, q));
    double4 q2 = r.hi / b.hi;
    r = dd_sub(r, dd_scale(b, q2));
    double4 q3 = r.hi / b.hi;
    return dd_add(quick_two_sum(q, q2), dd_from(q3));
}

// Within 25/8 u^2 (Lefevre, Louvet, Muller, Picot, Rideau, "Accurate calculation of Euclidean norms using double-word
// arithmetic", ACM TOMS 49(1), 2023).
static inline dd dd_sqrt(dd a)
{
    double4 root = sqrt(a.hi);
    double4 rest = fma(-root, root, a.hi) + a.lo;
    return quick_two_sum(root, rest / (2.0 * root));
}

static inline dd dd_dot3(const dd *a, const dd *b)
{
    return dd_add(dd_add(dd_mul(a[0], b[0]), dd_mul(a[1], b[1])), dd_mul(a[2], b[2]));
}

// a b - c d
static inline dd dd_minor(dd a, dd b, dd c, dd d) { return dd_sub(dd_mul(a, b), dd_mul(c, d)); }
