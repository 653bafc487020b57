// The rays of a frame as each quadric sees them in its parameter space: four quadrics per work-item, in double-double.
// Centring the pixel coordinates inside the quadric's own image is what removes the distance to the camera, squared,
// from every later rounding.

#define AT(vector, lane) (((__private double *)&(vector))[lane])

// A ray family as seen from parameter space: one fixed and one moving vector, affine in the pixel about `centre`.
typedef struct {
    dd fixed[4];
    dd moving[3][4];    // v-coefficient 0: u, 1: v, 2: constant
    dd map[3][3];       // parameter-space gradient row k to world, up to a positive factor: map[k]
    int in_range[4];    // underflow has no relative bound: the others are left to exact arithmetic
    double4 map_unit;   // brings the map's largest entry near 1
    // Sizes before any cancellation: every double-double above is within 2^-98 kappa times its size of exact.
    double4 kappa, map_norm, fixed_norm, moving_norm[3];
} family;

typedef struct {
    dd c[LINEAR];
} linear_form;

typedef struct {
    dd c[QUADRATIC];
} quadratic_form;

// Rows of `rays`: point 1, u, v, direction 1, u, v; each three double-doubles.
static inline dd ray_part(__global const double *rays, int part, int axis) { return dd_scalar(rays + 6 * part + 2 * axis); }

// Whether products of three such numbers, and their double-double tails, stay within binary64's normal range.
static inline int workable(double x) { return x == 0.0 || (fabs(x) > 0x1p-280 && fabs(x) < 0x1p280); }

static inline long4 all_workable(double4 x)
{
    double4 size = fabs(x);
    return (x == 0.0) | ((size > 0x1p-280) & (size < 0x1p280));
}

// 2^-k for x in [2^k, 2^(k+1)), k within +-1000; 1 for 0.
static inline double power_of_two_near_inverse(double x)
{
    long exponent = (as_long(x) >> 52) - 1023;
    return x > 0.0 ? as_double((1023 - clamp(exponent, -1000L, 1000L)) << 52) : 1.0;
}

// diag(1/radii) M^-1 as adj(M) / (det(M) radii), and the rays through it.
static void family_of(const int *quadric, const int2 *centre, __global const double *world_from_object,
                      __global const double *radii, __global const double *rays, double unit, int orthographic,
                      family *out)
{
    double4 m[3][4], r[3], shrink, u, v;
    for (int lane = 0; lane < 4; lane++) {
        int q = quadric[lane];
        double largest = 0.0;
        for (int k = 0; k < 12; k++) {
            AT(m[k / 4][k % 4], lane) = world_from_object[12 * q + k];
            largest = k % 4 < 3 ? fmax(largest, fabs(world_from_object[12 * q + k])) : largest;
        }
        AT(shrink, lane) = power_of_two_near_inverse(largest);
        for (int k = 0; k < 3; k++)
            AT(r[k], lane) = radii[3 * q + k];
        AT(u, lane) = centre[lane].x;
        AT(v, lane) = centre[lane].y;
    }
    // The world in a unit near the placement's own: nothing in parameter space changes, and determinants stay in range.
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m[i][j] *= shrink;
    dd adjugate[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            adjugate[j][i] = dd_sub(two_product(m[a][c], m[b][d]), two_product(m[a][d], m[b][c]));
        }
    dd determinant = dd_from((double4)(0.0));
    for (int j = 0; j < 3; j++)
        determinant = dd_add(determinant, dd_scale(adjugate[j][0], m[0][j]));
    for (int i = 0; i < 3; i++) {
        dd scale = dd_div(dd_from((double4)(1.0)), dd_scale(determinant, r[i]));
        for (int j = 0; j < 3; j++)
            out->map[i][j] = dd_mul(adjugate[i][j], scale);
    }

    for (int lane = 0; lane < 4; lane++) {
        double largest = 0.0;
        out->in_range[lane] = workable(AT(determinant.hi, lane));
        for (int k = 0; k < 9; k++) {
            double entry = AT(out->map[k / 3][k % 3].hi, lane);
            largest = fmax(largest, fabs(entry));
            out->in_range[lane] &= workable(entry) & workable(AT(m[k / 3][k % 3], lane)) & workable(AT(r[k % 3], lane));
        }
        AT(out->map_unit, lane) = power_of_two_near_inverse(largest);
    }
    double4 spread = (double4)(0.0), rows = (double4)(0.0);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            spread += m[i][j] * m[i][j];
            double4 row = out->map[i][j].hi * out->map_unit;
            rows += row * row;
        }
    out->kappa = 8.0 * spread * sqrt(spread) / fabs(determinant.hi);
    out->map_norm = sqrt(rows) / out->map_unit;

    dd point[3], direction[3];
    for (int k = 0; k < 3; k++) {
        point[k] = dd_sub(ray_part(rays, 0, k), dd_from(m[k][3]));
        direction[k] = ray_part(rays, 3, k);
        int part = orthographic ? 1 : 4;
        dd shift = dd_add(dd_scale(ray_part(rays, part, k), u), dd_scale(ray_part(rays, part + 1, k), v));
        if (orthographic)
            point[k] = dd_add(point[k], shift);
        else
            direction[k] = dd_add(direction[k], shift);
        point[k].hi *= shrink;
        point[k].lo *= shrink;
        direction[k].hi *= shrink * unit;
        direction[k].lo *= shrink * unit;
    }
    double4 scale = shrink * (orthographic ? 1.0 : unit);
    for (int i = 0; i < 3; i++) {
        out->fixed[i] = dd_dot3(out->map[i], orthographic ? direction : point);
        out->moving[2][i] = dd_dot3(out->map[i], orthographic ? point : direction);
        for (int k = 0; k < 2; k++) {
            dd part[3];
            for (int j = 0; j < 3; j++) {
                part[j] = ray_part(rays, (orthographic ? 1 : 4) + k, j);
                part[j].hi *= scale;
                part[j].lo *= scale;
            }
            out->moving[k][i] = dd_dot3(out->map[i], part);
        }
    }
    double4 point_norm = (double4)(0.0), direction_norm = (double4)(0.0);
    for (int k = 0; k < 3; k++) {
        // A double-double sum errs by its result's size; only an orthographic origin is itself rounded, to 2^-106.
        double4 p = fabs(point[k].hi), d = fabs(direction[k].hi);
        int part = orthographic ? 1 : 4;
        double4 shift = fabs(ray_part(rays, part, k).hi * u) + fabs(ray_part(rays, part + 1, k).hi * v);
        p += orthographic ? 0x1p-6 * shrink * (shift + fabs(ray_part(rays, 0, k).hi)) : (double4)(0.0);
        d += orthographic ? (double4)(0.0) : 0x1p-6 * shrink * unit * (shift + fabs(ray_part(rays, 3, k).hi));
        point_norm += p;
        direction_norm += d;
    }
    point_norm = point_norm * out->map_norm + 1.0;
    direction_norm *= out->map_norm;
    out->fixed_norm = orthographic ? direction_norm : point_norm;
    out->moving_norm[2] = orthographic ? point_norm : direction_norm;
    for (int k = 0; k < 2; k++) {
        double4 sum = (double4)(0.0);
        for (int j = 0; j < 3; j++)
            sum += fabs(ray_part(rays, (orthographic ? 1 : 4) + k, j).hi) * scale;
        out->moving_norm[k] = sum * out->map_norm;
    }
    dd one = dd_from((double4)(1.0)), zero = dd_from((double4)(0.0));
    out->fixed[3] = orthographic ? zero : one;
    out->moving[0][3] = out->moving[1][3] = zero;
    out->moving[2][3] = orthographic ? one : zero;
}

// Pluecker coordinate Lij = Fi Vj - Fj Vi.
static linear_form pluecker(const family *f, int i, int j)
{
    linear_form l;
    for (int k = 0; k < LINEAR; k++)
        l.c[k] = dd_minor(f->fixed[i], f->moving[k][j], f->fixed[j], f->moving[k][i]);
    return l;
}

// sum += weight p q
static void add_product(quadratic_form *sum, dd weight, const linear_form *p, const linear_form *q)
{
    dd w[LINEAR];
    for (int k = 0; k < LINEAR; k++)
        w[k] = dd_mul(weight, p->c[k]);
    sum->c[0] = dd_add(sum->c[0], dd_mul(w[0], q->c[0]));
    sum->c[1] = dd_add(sum->c[1], dd_add(dd_mul(w[0], q->c[1]), dd_mul(w[1], q->c[0])));
    sum->c[2] = dd_add(sum->c[2], dd_mul(w[1], q->c[1]));
    sum->c[3] = dd_add(sum->c[3], dd_add(dd_mul(w[0], q->c[2]), dd_mul(w[2], q->c[0])));
    sum->c[4] = dd_add(sum->c[4], dd_add(dd_mul(w[1], q->c[2]), dd_mul(w[2], q->c[1])));
    sum->c[5] = dd_add(sum->c[5], dd_mul(w[2], q->c[2]));
}

// The quadrics of a work-item's lanes and their centres; the last one stands in for those beyond the end.
static void quads_of(__global const int *list, __global const int2 *middle, int count, int first, int *quadric, int2 *centre)
{
    for (int lane = 0; lane < 4; lane++) {
        quadric[lane] = list[min(first + lane, count - 1)];
        centre[lane] = middle[quadric[lane]];
    }
}

// Place of entry (i, j) in the ten of a symmetric 4x4 form.
static int upper(int i, int j)
{
    const int start[4] = {0, 4, 7, 9};
    return i <= j ? start[i] + j - i : start[j] + i - j;
}
