// Unnormalised normals of winners, in target space (world or camera).

typedef struct {
    reals x, y, z;
#if EXACT
    reals error;    // bound of the error's length
#endif
} vector3;

typedef struct {
    linear x[3], y[3], moment[3];
    real form[10], map[3][3], face[2][3];
#if EXACT
    real floor, root, root_error;    // the error of a component: floor + root sqrt(S) + root_error (its error)
    real rounding;                      // and, once scaled to size 1, this
#endif
} general_normal;

#if EXACT
static inline real size_of(const linear *l, int count, real *error)
{
    real size = 0;
    for (int k = 0; k < count; k++) {
        size += fabs(l[k].one) + (TILE / 2) * (fabs(l[k].u) + fabs(l[k].v));
        *error += l[k].error;
    }
    return size;
}

// First-order bounds by the sums of magnitudes: p of the vectors X, Y, l of the Pluecker coordinates, d of the form,
// m of the map; constants count the roundings of general_normal_at and are rounded up.
static inline void bound_general_normal(general_normal *m, __global const general_record *r, double du, double dv)
{
    double noise = 0x1p-95 * r->kappa * r->fixed_norm * norm_at(r->moving_norm, du, dv);
    real point_error = 0, moment_error = 0;
    real x = 1 + size_of(m->x, 3, &point_error), y = size_of(m->y, 3, &point_error);
    real l = y + size_of(m->moment, 3, &moment_error);
    real p = x > y ? x : y, d = (real)r->form_sum, map = 0;
    point_error += 0x1p-95 * r->kappa * (r->fixed_norm + norm_at(r->moving_norm, du, dv));
    moment_error += point_error + noise;
    for (int k = 0; k < 9; k++)
        map += fabs(m->map[k / 3][k % 3]);
    real scale = 2 * map * d;
    m->floor = m->root = m->root_error = m->rounding = 0;
    // A plane's gradient is one row of the form times V4 wherever it is met: a few relative roundings, no more.
    if (r->spatial_sum == 0.0)
        return;
    m->rounding = 16 * UNIT_ROUNDOFF * scale;
    m->floor = scale * (16 * UNIT_ROUNDOFF * d * p * l + d * (point_error * l + p * moment_error));
    m->root = scale * (point_error + 4 * UNIT_ROUNDOFF * p);
    m->root_error = scale * p;
}
#endif

static inline general_normal move_general_normal(__global const general_record *r, double du, double dv)
{
    general_normal m;
    for (int j = 0; j < 3; j++) {
        m.x[j] = move_linear(r->x[j], du, dv);
        m.y[j] = move_linear(r->y[j], du, dv);
        m.moment[j] = move_linear(r->moment[j], du, dv);
        for (int k = 0; k < 3; k++)
            m.map[j][k] = (real)r->normal[j][k];
    }
    for (int k = 0; k < 10; k++)
        m.form[k] = (real)r->form[k];
    for (int k = 0; k < 6 && (r->flags & SHEETS); k++)
        m.face[k / 3][k % 3] = (real)r->face[k / 3][k % 3];
#if EXACT
    bound_general_normal(&m, r, du, dv);
#endif
    return m;
}

#if EXACT
// With f = k L L' the gradient on L = 0 is k L' times that of L, and k L' there is -`sheet` over the slope of L; on
// L' = 0 it is +`sheet` over the slope of L'.
static inline vector3 sheet_normal_at(const general_tile *g, const general_normal *m, mask kind, int outward, reals x,
                                      real y, vector3 cap)
{
    mask first = kind == 0, is_cap = kind >= CAP_LOW;
    mask inward = (at_linear(g->sheet, x, y) < 0) ^ ~first;
    reals turn = (outward ? inward : (mask)(0)) ? (reals)(-1) : (reals)(1);
    vector3 n;
    n.x = is_cap ? cap.x : turn * (first ? (reals)(m->face[0][0]) : (reals)(m->face[1][0]));
    n.y = is_cap ? cap.y : turn * (first ? (reals)(m->face[0][1]) : (reals)(m->face[1][1]));
    n.z = is_cap ? cap.z : turn * (first ? (reals)(m->face[0][2]) : (reals)(m->face[1][2]));
    n.error = is_cap ? cap.error : (reals)(2 * UNIT_ROUNDOFF);
    return n;
}
#endif

// The gradient at t = q/a is along D(aX - bY - sign(b) sqrt(S) Y), at t = c/q along D(cY - bX - sign(b) sqrt(S) X),
// with aX - bY = sum_k (DY)_k L_ik and cY - bX = -sum_k (DX)_k L_ik: nothing cancels far from the origin.
__attribute__((noinline)) static vector3 general_normal_at(const general_tile *g, const general_normal *m, mask kind, int outward,
                                        reals px, real py)
{
    reals X[3], Y[3];
    for (int j = 0; j < 3; j++) {
        X[j] = at_linear(m->x[j], px, py);
        Y[j] = at_linear(m->y[j], px, py);
    }
    reals l12 = at_linear(m->moment[0], px, py), l13 = at_linear(m->moment[1], px, py),
          l23 = at_linear(m->moment[2], px, py);
    const real *d = m->form;
    reals s = at_quadratic(g->s, px, py);
    reals root = s > 0 ? sqrt(s) : (reals)(0);
    reals a = at_quadratic(g->a, px, py), b = at_linear(g->b, px, py);
    mask is_a = kind == ROOT_A;
    // P is Y for roots of kind A, X for kind C; P4 likewise.
    reals p1 = is_a ? Y[0] : X[0], p2 = is_a ? Y[1] : X[1], p3 = is_a ? Y[2] : X[2];
    reals p4 = is_a ? (reals)(0) : (reals)(1);
    reals e1 = d[0] * p1 + d[1] * p2 + d[2] * p3 + d[3] * p4;
    reals e2 = d[1] * p1 + d[4] * p2 + d[5] * p3 + d[6] * p4;
    reals e3 = d[2] * p1 + d[5] * p2 + d[7] * p3 + d[8] * p4;
    reals e4 = d[3] * p1 + d[6] * p2 + d[8] * p3 + d[9] * p4;
    reals v1 = e2 * l12 + e3 * l13 - e4 * Y[0];
    reals v2 = e3 * l23 - e1 * l12 - e4 * Y[1];
    reals v3 = -e1 * l13 - e2 * l23 - e4 * Y[2];
    reals v4 = e1 * Y[0] + e2 * Y[1] + e3 * Y[2];
    reals sign = is_a ? (reals)(1) : (reals)(-1);
    reals signed_root = b < 0 ? -root : root;
    v1 = sign * v1 - signed_root * p1;
    v2 = sign * v2 - signed_root * p2;
    v3 = sign * v3 - signed_root * p3;
    v4 = sign * v4 - signed_root * p4;
    // Keeps the squares below within binary32's range.
    reals size = magnitude(v1) + magnitude(v2) + magnitude(v3) + magnitude(v4);
    size = size > 0 ? size : (reals)(1);
    reals per_size = 1 / size;
    v1 *= per_size;
    v2 *= per_size;
    v3 *= per_size;
    v4 *= per_size;
    reals g1 = d[0] * v1 + d[1] * v2 + d[2] * v3 + d[3] * v4;
    reals g2 = d[1] * v1 + d[4] * v2 + d[5] * v3 + d[6] * v4;
    reals g3 = d[2] * v1 + d[5] * v2 + d[7] * v3 + d[8] * v4;
    // Outward: divided by a (kind A) or by q = -b - sign(b) sqrt(S) (kind C), of which only the sign matters.
    reals divisor = is_a ? a : (b < 0 ? root - b : -(root + b));
    // b + at = -sign(b) sqrt(S) at kind A, + at kind C; facing wants it negative.
    mask away = is_a ? (b < 0) : (b >= 0);
    mask flip = (divisor < 0) ^ (outward ? (mask)(0) : (away & (root > 0)));
    mask low = kind == CAP_LOW, cap = low | (kind == CAP_HIGH);
    g1 = cap ? (reals)(0) : g1;
    g2 = cap ? (reals)(0) : g2;
    g3 = cap ? (reals)(1) : g3;
    mask cap_flip = outward ? low : (Y[2] > 0);
    flip = cap ? cap_flip : flip;
    reals turn = flip ? (reals)(-1) : (reals)(1);
    if (g->flags & SINGULAR) {
        mask vanishes = ~cap;
        g1 = vanishes ? (reals)(0) : g1;
        g2 = vanishes ? (reals)(0) : g2;
        g3 = vanishes ? (reals)(0) : g3;
    }
    vector3 n;
    n.x = turn * (m->map[0][0] * g1 + m->map[0][1] * g2 + m->map[0][2] * g3);
    n.y = turn * (m->map[1][0] * g1 + m->map[1][1] * g2 + m->map[1][2] * g3);
    n.z = turn * (m->map[2][0] * g1 + m->map[2][1] * g2 + m->map[2][2] * g3);
    // Again, for the caller's squares: the map may shrink some axes by any amount.
    reals length = magnitude(n.x) + magnitude(n.y) + magnitude(n.z);
    reals grow = length > 0 ? 1 / length : (reals)(0);
    n.x *= grow;
    n.y *= grow;
    n.z *= grow;
#if EXACT
    reals root_error = g->s.error > 0 ? g->s.error / root : (reals)(0);
    n.error = ((m->floor + m->root * root + m->root_error * root_error) * per_size + m->rounding) * grow * 1.7321;
    // A cap's normal is one row of the map, a singular surface has none.
    // One whose components all vanish, or seem to, is in doubt.
    n.error = length > 0 ? n.error : (reals)(1);
    // Nor is it clear which of the roots is meant where b may have either sign.
    n.error = magnitude(b) >= g->b.error ? n.error : (reals)(1);
    n.error = (cap | ((g->flags & SINGULAR) ? (mask)(-1) : (mask)(0))) ? (reals)(0) : n.error;
    if (g->flags & SHEETS)
        n = sheet_normal_at(g, m, kind, outward, px, py, n);
#endif
    return n;
}
