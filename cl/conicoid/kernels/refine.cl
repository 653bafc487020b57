// The values of pixels whose hit is certain and whose rounding is not, in double-double: four pixels per work-item.

// One pixel of the list: what is seen there, in and out of `refine_values`.
typedef struct {
    double depth;       // as casting found it
    int x, y;           // in the whole image
    int quadric, kind;  // kind: a cap, or one of the roots, as in candidates.h
    int certain;        // whether every value below is rounded for certain
    float z, t, n[3], p[3];
} refined_pixel;

#define WANT_T 2
#define WANT_N 8
#define WANT_P 16

#define CAP_LOW 2

#define NORMAL_STEP 0x1p-23

// Relative, of a sum or product of double-doubles; family.h has those of its own.
#define DD_ERROR 0x1p-98

typedef struct {
    dd value;
    double4 error;
} bounded;

static inline bounded bounded_sum(bounded a, bounded b)
{
    dd sum = dd_add(a.value, b.value);
    return (bounded){sum, a.error + b.error + DD_ERROR * fabs(sum.hi)};
}

static inline bounded bounded_product(bounded a, bounded b)
{
    dd product = dd_mul(a.value, b.value);
    double4 error = fabs(a.value.hi) * b.error + fabs(b.value.hi) * a.error + a.error * b.error;
    return (bounded){product, 1.01 * error + DD_ERROR * fabs(product.hi)};
}

// Infinite where the divisor is not clear of its error.
static inline bounded bounded_quotient(bounded a, bounded b)
{
    dd quotient = dd_div(a.value, b.value);
    double4 size = fabs(b.value.hi), error = 1.1 * (a.error + fabs(quotient.hi) * b.error) / size;
    return (bounded){quotient, size >= 16.0 * b.error ? error + DD_ERROR * fabs(quotient.hi) : (double4)(INFINITY)};
}

static inline bounded bounded_root(bounded a)
{
    dd root = dd_sqrt(a.value);
    return (bounded){root, a.value.hi >= 16.0 * a.error ? a.error / root.hi + DD_ERROR * root.hi : (double4)(INFINITY)};
}

static inline bounded bounded_choice(long4 first, bounded a, bounded b)
{
    return (bounded){{first ? a.value.hi : b.value.hi, first ? a.value.lo : b.value.lo}, first ? a.error : b.error};
}

static inline bounded bounded_negative(bounded a) { return (bounded){dd_neg(a.value), a.error}; }

static inline bounded exactly(double4 x) { return (bounded){dd_from(x), (double4)(0.0)}; }

// The nearest binary32, and whether nothing within the error rounds otherwise. Numbers that binary32 holds with fewer bits,
// or not at all, are left open.
static float round_to_float(double hi, double lo, double error, int *certain)
{
    float nearest = (float)hi;
    double size = fabs(hi), off = hi - (double)nearest;
    double half_ulp = as_double(as_long(size) & 0x7ff0000000000000L) * 0x1p-24;
    // Exactly between two of them, hi alone went to the even one.
    if (fabs(off) == half_ulp && off * lo > 0.0) {
        nearest = as_float(as_int(nearest) + ((off > 0.0) == (hi > 0.0) ? 1 : -1));
        off = hi - (double)nearest;
    }
    // Below a power of two the next boundary is half as far.
    *certain &= half_ulp - fabs(off + lo) > error + 0x1p-76 * size && error < 0.25 * half_ulp;
    *certain &= size > 0x1p-125 && size < 0x1p127;
    return nearest;
}

static double round_to_multiple(double hi, double lo, double error, double step, int *certain)
{
    double shift = step * 0x1.8p52, nearest = (hi + shift) - shift;
    *certain &= fabs((hi - nearest) + lo) + error + 0x1p-76 * step < 0.5 * step;
    return nearest + 0.0;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void refine_values(int count, __global refined_pixel *pixels, __global const double *world_from_object,
                   __global const double *radii, __global const uchar *shape, __global const double *shape_form,
                   __global const int *matrix_row, __global const double *matrix, __global const double *z_range,
                   __global const double *rays, double unit, int orthographic, __global const double *target,
                   double4 intrinsics, int outward, int channels)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int quadric[4];
    int2 pixel[4];
    long4 cap, low;
    double4 u, v, height, seen;
    for (int lane = 0; lane < 4; lane++) {
        __global const refined_pixel *p = pixels + min(first + lane, count - 1);
        quadric[lane] = p->quadric;
        pixel[lane] = (int2)(p->x, p->y);
        AT(u, lane) = p->x + 0.5;
        AT(v, lane) = p->y + 0.5;
        AT(seen, lane) = p->depth / unit;
        ((__private long *)&cap)[lane] = p->kind >= CAP_LOW ? -1 : 0;
        ((__private long *)&low)[lane] = p->kind == CAP_LOW ? -1 : 0;
        double z = z_range[2 * p->quadric + (p->kind == CAP_LOW ? 0 : 1)];
        AT(height, lane) = isfinite(z) ? z : 0.0;
    }
    family f;
    family_of(quadric, pixel, world_from_object, radii, rays, unit, orthographic, &f);

    // X + tY at the pixel's centre, half a pixel from the family's.
    double4 fixed_error = DD_ERROR * f.kappa * f.fixed_norm;
    double4 moving_error = DD_ERROR * f.kappa * (f.moving_norm[0] + f.moving_norm[1] + f.moving_norm[2]);
    bounded x[4], y[4];
    for (int i = 0; i < 4; i++) {
        dd offset = dd_scale(dd_add(f.moving[0][i], f.moving[1][i]), (double4)(0.5));
        bounded fixed = {f.fixed[i], fixed_error}, moving = {dd_add(f.moving[2][i], offset), moving_error};
        x[i] = orthographic ? moving : fixed;
        y[i] = orthographic ? fixed : moving;
    }
    x[3] = exactly((double4)(1.0));
    y[3] = exactly((double4)(0.0));

    // The form's rows at X and Y.
    bounded dx[4], dy[4], form[10];
    for (int lane = 0; lane < 4; lane++)
        for (int i = 0, k = 0; i < 4; i++)
            for (int j = i; j < 4; j++, k++) {
                int row = matrix_row[quadric[lane]];
                double d = row < 0 ? shape_form[10 * shape[quadric[lane]] + k] : matrix[16 * row + 4 * i + j];
                AT(form[k].value.hi, lane) = d;
                AT(form[k].value.lo, lane) = AT(form[k].error, lane) = 0.0;
            }
    bounded a = exactly((double4)(0.0)), b = a, c = a;
    for (int i = 0; i < 4; i++) {
        dx[i] = dy[i] = exactly((double4)(0.0));
        for (int j = 0; j < 4; j++) {
            dx[i] = bounded_sum(dx[i], bounded_product(form[upper(i, j)], x[j]));
            dy[i] = bounded_sum(dy[i], bounded_product(form[upper(i, j)], y[j]));
        }
        a = bounded_sum(a, bounded_product(dy[i], y[i]));
        b = bounded_sum(b, bounded_product(dx[i], y[i]));
        c = bounded_sum(c, bounded_product(dx[i], x[i]));
    }
    bounded s = bounded_sum(bounded_product(b, b), bounded_negative(bounded_product(a, c)));
    bounded root = bounded_root(s);
    bounded q = bounded_choice(b.value.hi < 0.0, bounded_sum(root, bounded_negative(b)), bounded_negative(bounded_sum(root, b)));
    bounded third_radius = exactly((double4)(0.0));
    for (int lane = 0; lane < 4; lane++)
        AT(third_radius.value.hi, lane) = radii[3 * quadric[lane] + 2];
    bounded level = bounded_quotient(exactly(height), third_radius);
    bounded below = bounded_sum(level, bounded_negative(x[2]));
    // Which root is which hangs by the sign of b, which here may be another than in casting: that nearer to what casting
    // found, which is no farther from it than a quarter of the way to the other.
    bounded t_a = bounded_quotient(q, a), t_c = bounded_quotient(c, q);
    double4 off_a = fabs(t_a.value.hi - seen), off_c = fabs(t_c.value.hi - seen);
    long4 is_a = ~(off_c <= off_a);
    bounded t = bounded_choice(cap, bounded_quotient(below, y[2]), bounded_choice(is_a, t_a, t_c));
    long4 told = cap | (4.0 * (is_a ? off_a : off_c) <= fabs(t_a.value.hi - t_c.value.hi));

    // The gradient in parameter space, and its slope along the ray.
    bounded gradient[3], slope = exactly((double4)(0.0));
    for (int i = 0; i < 3; i++) {
        bounded of_cap = exactly((double4)(i == 2 ? 1.0 : 0.0) * (low ? (double4)(-1.0) : (double4)(1.0)));
        gradient[i] = bounded_choice(cap, of_cap, bounded_sum(dx[i], bounded_product(t, dy[i])));
        slope = bounded_sum(slope, bounded_product(gradient[i], y[i]));
    }
    // Which side faces the eye must be clear.
    long4 open = outward ? (long4)(0) : ~(fabs(slope.value.hi) > slope.error);
    double4 turn = (slope.value.hi > 0.0) & (long4)(outward ? 0 : -1) ? (double4)(-1.0) : (double4)(1.0);
    bounded world[3], normal[3], square = exactly((double4)(0.0));
    for (int j = 0; j < 3; j++) {
        world[j] = exactly((double4)(0.0));
        for (int k = 0; k < 3; k++) {
            bounded entry = {dd_scale(f.map[k][j], f.map_unit), DD_ERROR * f.kappa * f.map_norm * f.map_unit};
            world[j] = bounded_sum(world[j], bounded_product(entry, gradient[k]));
        }
    }
    for (int j = 0; j < 3; j++) {
        normal[j] = exactly((double4)(0.0));
        for (int k = 0; k < 3; k++)
            normal[j] = bounded_sum(normal[j], bounded_product(exactly((double4)(target[3 * k + j]) * turn), world[k]));
        square = bounded_sum(square, bounded_product(normal[j], normal[j]));
    }
    bounded length = bounded_root(square);

    dd per_unit = dd_from((double4)(unit));
    bounded depth = {dd_mul(t.value, per_unit), t.error * unit};
    // |d| in camera axes: ((u - cx)/fx, (v - cy)/fy, 1) for a pinhole, 1 for parallel rays.
    bounded steps = exactly((double4)(1.0));
    if (!orthographic) {
        bounded across = {two_sum(u, (double4)(-intrinsics.z)), (double4)(0.0)};
        bounded down = {two_sum(v, (double4)(-intrinsics.w)), (double4)(0.0)};
        across = bounded_quotient(across, exactly((double4)(intrinsics.x)));
        down = bounded_quotient(down, exactly((double4)(intrinsics.y)));
        steps = bounded_sum(steps, bounded_sum(bounded_product(across, across), bounded_product(down, down)));
    }
    bounded distance = bounded_product(depth, bounded_root(steps));
    bounded position[3];
    for (int k = 0; k < 3; k++) {
        bounded part[2];
        for (int side = 0; side < 2; side++) {
            part[side] = (bounded){ray_part(rays, 3 * side, k), DD_ERROR * fabs(ray_part(rays, 3 * side, k).hi)};
            for (int axis = 1; axis < 3; axis++) {
                dd per_pixel = ray_part(rays, 3 * side + axis, k);
                bounded along = {dd_scale(per_pixel, axis == 1 ? u : v), (double4)(0.0)};
                along.error = 2.0 * DD_ERROR * fabs(along.value.hi);
                part[side] = bounded_sum(part[side], along);
            }
        }
        position[k] = bounded_sum(part[0], bounded_product(depth, part[1]));
    }

    for (int lane = 0; lane < 4 && first + lane < count; lane++) {
        __global refined_pixel *p = pixels + first + lane;
        int certain = f.in_range[lane] && ((__private const long *)&told)[lane] != 0;
        p->z = round_to_float(AT(depth.value.hi, lane), AT(depth.value.lo, lane), AT(depth.error, lane), &certain);
        if (channels & WANT_T)
            p->t = round_to_float(AT(distance.value.hi, lane), AT(distance.value.lo, lane), AT(distance.error, lane), &certain);
        if (channels & WANT_N) {
            certain &= !((__private const long *)&open)[lane];
            for (int j = 0; j < 3; j++) {
                bounded unit_normal = bounded_quotient(normal[j], length);
                p->n[j] = round_to_multiple(AT(unit_normal.value.hi, lane), AT(unit_normal.value.lo, lane),
                                            AT(unit_normal.error, lane), NORMAL_STEP, &certain);
            }
        }
        if (channels & WANT_P) {
            int largest = 0;
            for (int j = 1; j < 3; j++)
                largest = fabs(AT(position[j].value.hi, lane)) > fabs(AT(position[largest].value.hi, lane)) ? j : largest;
            bounded top = position[largest];
            float rounded = round_to_float(AT(top.value.hi, lane), AT(top.value.lo, lane), AT(top.error, lane), &certain);
            double step = as_float(as_int(rounded) & 0x7f800000) * 0x1p-23;
            certain &= fabs(rounded) > 0x1p-99f;
            for (int j = 0; j < 3; j++)
                p->p[j] = round_to_multiple(AT(position[j].value.hi, lane), AT(position[j].value.lo, lane),
                                            AT(position[j].error, lane), step, &certain);
        }
        p->certain = certain;
    }
}
