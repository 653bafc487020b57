// Forms and polynomials of the quadrics that can be seen: four per work-item, in double-double as far as anything
// cancels. Recentring every polynomial on a pixel inside the quadric's own image is what removes the distance to
// the camera, squared, from every later rounding.

#define AT(vector, lane) (((__private double *)&(vector))[lane])

// A ray family as seen from parameter space: one fixed and one moving vector, affine in the pixel about `centre`.
typedef struct {
    dd fixed[4];
    dd moving[3][4];    // v-coefficient 0: u, 1: v, 2: constant
    dd map[3][3];       // parameter-space gradient row k to world: map[k]
    // Sizes before any cancellation: every double-double above is within 2^-98 kappa times its size of exact.
    double4 kappa, map_norm, fixed_norm, moving_norm[3];
    int4 centre_u, centre_v;
} family;

typedef struct {
    dd c[LINEAR];
} linear_form;

typedef struct {
    dd c[QUADRATIC];
} quadratic_form;

// Rows of `rays`: point 1, u, v, direction 1, u, v; each three double-doubles.
static inline dd ray_part(__global const double *rays, int part, int axis) { return dd_scalar(rays + 6 * part + 2 * axis); }

// diag(1/radii) M^-1 as adj(M) / (det(M) radii), and the rays through it.
static void family_of(const int *quadric, __global const double *world_from_object, __global const double *radii,
                      __global const int2 *middle, __global const double *rays, double unit, int orthographic, family *out)
{
    double4 m[3][4], r[3];
    for (int lane = 0; lane < 4; lane++) {
        int q = quadric[lane];
        for (int k = 0; k < 12; k++)
            AT(m[k / 4][k % 4], lane) = world_from_object[12 * q + k];
        for (int k = 0; k < 3; k++)
            AT(r[k], lane) = radii[3 * q + k];
        ((__private int *)&out->centre_u)[lane] = middle[q].x;
        ((__private int *)&out->centre_v)[lane] = middle[q].y;
    }
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

    double4 spread = (double4)(0.0), rows = (double4)(0.0);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            spread += m[i][j] * m[i][j];
            rows += out->map[i][j].hi * out->map[i][j].hi;
        }
    out->kappa = 8.0 * spread * sqrt(spread) / fabs(determinant.hi);
    out->map_norm = sqrt(rows);

    double4 u = convert_double4(out->centre_u), v = convert_double4(out->centre_v);
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
        direction[k].hi *= unit;
        direction[k].lo *= unit;
    }
    double scale = orthographic ? 1.0 : unit;
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
        p += orthographic ? 0x1p-6 * (shift + fabs(ray_part(rays, 0, k).hi)) : (double4)(0.0);
        d += orthographic ? (double4)(0.0) : 0x1p-6 * unit * (shift + fabs(ray_part(rays, 3, k).hi));
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

static void quads_of(__global const int *list, int count, int first, int *quadric)
{
    for (int lane = 0; lane < 4; lane++)
        quadric[lane] = list[min(first + lane, count - 1)];
}

// Ellipsoids: D = diag(1, 1, 1, -1), so S = |V4 F - F4 V|^2 - |F x V|^2 with no cancellation but the silhouette's
// own; from the double-double forms on, binary64 loses nothing that casting would keep.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void set_up_simple(int count, __global const int *list, __global const double *world_from_object,
                   __global const double *radii, __global const int2 *middle, __global const double *rays, double unit,
                   int orthographic, __global const double *target, __global simple_record *records)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int quadric[4];
    quads_of(list, count, first, quadric);
    family f;
    family_of(quadric, world_from_object, radii, middle, rays, unit, orthographic, &f);

    dd norm = dd_sub(dd_dot3(f.fixed, f.fixed), dd_mul(f.fixed[3], f.fixed[3]));
    double4 ff = norm.hi;
    double4 l[6][LINEAR];   // L12 L13 L23 L14 L24 L34
    const int first_of[6] = {0, 0, 1, 0, 1, 2}, second_of[6] = {1, 2, 2, 3, 3, 3};
    for (int p = 0; p < 6; p++) {
        linear_form form = pluecker(&f, first_of[p], second_of[p]);
        for (int k = 0; k < LINEAR; k++)
            l[p][k] = form.c[k].hi;
    }
    double4 s[QUADRATIC];
    for (int k = 0; k < QUADRATIC; k++)
        s[k] = (double4)(0.0);
    for (int p = 0; p < 6; p++) {
        double4 sign = p < 3 ? (double4)(-1.0) : (double4)(1.0);
        double4 x = sign * l[p][0], y = sign * l[p][1], z = sign * l[p][2];
        s[0] = fma(x, l[p][0], s[0]);
        s[1] = fma(2.0 * x, l[p][1], s[1]);
        s[2] = fma(y, l[p][1], s[2]);
        s[3] = fma(2.0 * x, l[p][2], s[3]);
        s[4] = fma(2.0 * y, l[p][2], s[4]);
        s[5] = fma(z, l[p][2], s[5]);
    }
    // Pinhole: key = s = -b/c + sqrt(S)/|c|, on X + Y/s. Orthographic: key = -t = b/a + sqrt(S)/a.
    double4 b[LINEAR], n[3][LINEAR], g[3];
    double4 root_sign = orthographic ? (double4)(-1.0) : (double4)(1.0);
    for (int k = 0; k < LINEAR; k++) {
        dd fv = dd_sub(dd_dot3(f.fixed, f.moving[k]), dd_mul(f.fixed[3], f.moving[k][3]));
        b[k] = -root_sign * fv.hi / ff;
        // D(V - (b/ff) F) without its cancellation: -sum_k (DF)_k L_ik / ff.
        double4 w[3];
        w[0] = f.fixed[1].hi * l[0][k] + f.fixed[2].hi * l[1][k] - f.fixed[3].hi * l[3][k];
        w[1] = -f.fixed[0].hi * l[0][k] + f.fixed[2].hi * l[2][k] - f.fixed[3].hi * l[4][k];
        w[2] = -f.fixed[0].hi * l[1][k] - f.fixed[1].hi * l[2][k] - f.fixed[3].hi * l[5][k];
        for (int j = 0; j < 3; j++)
            n[j][k] = -(f.map[0][j].hi * w[0] + f.map[1][j].hi * w[1] + f.map[2][j].hi * w[2]) / ff;
    }
    for (int j = 0; j < 3; j++)
        g[j] = root_sign * (f.map[0][j].hi * f.fixed[0].hi + f.map[1][j].hi * f.fixed[1].hi + f.map[2][j].hi * f.fixed[2].hi);
    for (int k = 0; k < QUADRATIC; k++)
        s[k] = (s[k] / ff) / ff;

    // Norms of the moments, widened by what double-double lost: 2 |l| d + d^2 <= 40u ((|l| + d / 40u)^2 - |l|^2).
    double4 s_norm[LINEAR], b_norm[LINEAR], n_norm[LINEAR], f_norm = (double4)(0.0);
    for (int i = 0; i < 4; i++)
        f_norm += f.fixed[i].hi * f.fixed[i].hi;
    f_norm = sqrt(f_norm);
    // An eye so near the surface that F'DF itself is in doubt gives infinite bounds: exact arithmetic takes over.
    double4 certain = fabs(ff) > 0x1p-38 * f.kappa * f.fixed_norm * f.fixed_norm ? (double4)(1.0) : (double4)(INFINITY);
    for (int k = 0; k < LINEAR; k++) {
        double4 moment = (double4)(0.0), moving = (double4)(0.0);
        for (int p = 0; p < 6; p++)
            moment += l[p][k] * l[p][k];
        for (int i = 0; i < 4; i++)
            moving += f.moving[k][i].hi * f.moving[k][i].hi;
        moment = sqrt(moment) + 0x1p-48 * f.kappa * f.fixed_norm * f.moving_norm[k];
        s_norm[k] = certain * moment / fabs(ff);
        b_norm[k] = certain * (f_norm * sqrt(moving) + 0x1p-44 * f.kappa * f.fixed_norm * f.moving_norm[k]) / fabs(ff);
        n_norm[k] = certain * f.map_norm * f_norm * moment / fabs(ff);
    }
    double4 g_norm = f.map_norm * (f_norm + 0x1p-44 * f.kappa * f.fixed_norm);

    // Normals to unit length at the centre: binary32 casting squares them.
    double4 length = (double4)(0.0);
    for (int j = 0; j < 3; j++)
        length += n[j][2] * n[j][2] + g[j] * g[j] * fabs(s[5]);
    length = 1.0 / sqrt(length);
    for (int lane = 0; lane < 4 && first + lane < count; lane++) {
        __global simple_record *r = records + first + lane;
        double scale = AT(length, lane);
        scale = isfinite(scale) ? scale : 1.0;
        for (int k = 0; k < QUADRATIC; k++)
            r->s[k] = AT(s[k], lane);
        for (int k = 0; k < LINEAR; k++)
            r->b[k] = AT(b[k], lane);
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < LINEAR; k++)
                r->n[j][k] = scale * (target[j] * AT(n[0][k], lane) + target[3 + j] * AT(n[1][k], lane) + target[6 + j] * AT(n[2][k], lane));
            r->g[j] = scale * (target[j] * AT(g[0], lane) + target[3 + j] * AT(g[1], lane) + target[6 + j] * AT(g[2], lane));
        }
        // A target frame is a rotation within 1e-6.
        for (int k = 0; k < LINEAR; k++) {
            r->s_norm[k] = AT(s_norm[k], lane);
            r->b_norm[k] = AT(b_norm[k], lane);
            r->n_norm[k] = 2.0 * scale * AT(n_norm[k], lane);
        }
        r->g_norm = 2.0 * scale * AT(g_norm, lane);
        r->centre[0] = middle[quadric[lane]].x;
        r->centre[1] = middle[quadric[lane]].y;
    }
}

static inline void store(__global double *out, const dd *values, int count, int lane)
{
    for (int k = 0; k < count; k++)
        out[k] = ((__private const double *)&values[k].hi)[lane];
}

static int upper(int i, int j)
{
    const int start[4] = {0, 4, 7, 9};
    return i <= j ? start[i] + j - i : start[j] + i - j;
}

static inline int nonzero(dd x) { return any(x.hi != (double4)(0.0)); }

// Every other quadric: S = -L' C2(D) L with D's second compound matrix (Cauchy-Binet), so that S is exactly zero for
// a double plane and a sum of squares where the surface is real everywhere.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void set_up_general(int count, __global const int *list, __global const double *world_from_object,
                    __global const double *radii, __global const uchar *shape, __global const double *shape_form,
                    __global const int *matrix_row, __global const double *matrix, __global const double *z_range,
                    __global const uchar *capped, __global const int *form_flags, __global const int *clip_start,
                    __global const int2 *middle, __global const double *rays, double unit, int orthographic,
                    __global const double *target, __global general_record *records)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int quadric[4];
    quads_of(list, count, first, quadric);
    family f;
    family_of(quadric, world_from_object, radii, middle, rays, unit, orthographic, &f);

    dd form[10];
    for (int lane = 0; lane < 4; lane++) {
        int q = quadric[lane];
        for (int i = 0, k = 0; i < 4; i++)
            for (int j = i; j < 4; j++, k++) {
                int row = matrix_row[q];
                AT(form[k].hi, lane) = row < 0 ? shape_form[10 * shape[q] + k] : matrix[16 * row + 4 * i + j];
                AT(form[k].lo, lane) = 0.0;
            }
    }

    const int first_of[6] = {0, 0, 1, 0, 1, 2}, second_of[6] = {1, 2, 2, 3, 3, 3};
    linear_form l[6];
    for (int p = 0; p < 6; p++)
        l[p] = pluecker(&f, first_of[p], second_of[p]);

    double4 form_sum = (double4)(0.0), spatial_sum = (double4)(0.0), compound_sum = (double4)(0.0);
    dd zero = dd_from((double4)(0.0));
    quadratic_form s, vv;
    dd fv[LINEAR], ff = zero;
    for (int k = 0; k < QUADRATIC; k++)
        s.c[k] = vv.c[k] = zero;
    for (int k = 0; k < LINEAR; k++)
        fv[k] = zero;
    for (int p = 0; p < 6; p++)
        for (int q = p; q < 6; q++) {
            int i = first_of[p], j = second_of[p], k = first_of[q], m = second_of[q];
            dd compound = dd_minor(form[upper(i, k)], form[upper(j, m)], form[upper(i, m)], form[upper(j, k)]);
            compound_sum += (p == q ? 1.0 : 2.0) * fabs(compound.hi);
            if (nonzero(compound))
                add_product(&s, dd_scale(compound, (double4)(p == q ? -1.0 : -2.0)), &l[p], &l[q]);
        }
    for (int i = 0; i < 4; i++) {
        linear_form vi;
        for (int k = 0; k < LINEAR; k++)
            vi.c[k] = f.moving[k][i];
        for (int j = 0; j < 4; j++) {
            dd d = form[upper(i, j)];
            form_sum += fabs(d.hi);
            if (i < 3 && j < 3)
                spatial_sum += fabs(d.hi);
            if (!nonzero(d))
                continue;
            linear_form vj;
            for (int k = 0; k < LINEAR; k++) {
                vj.c[k] = f.moving[k][j];
                fv[k] = dd_add(fv[k], dd_mul(dd_mul(d, f.fixed[i]), f.moving[k][j]));
            }
            ff = dd_add(ff, dd_mul(dd_mul(d, f.fixed[i]), f.fixed[j]));
            add_product(&vv, d, &vi, &vj);
        }
    }

    // Extent planes at z/c, and the cap conics EDE with E = X Y3' - Y X3', the point where the ray meets the plane.
    dd range[2][LINEAR];
    double4 end[2];
    quadratic_form cap[2];
    for (int side = 0; side < 2; side++) {
        double4 z, c;
        for (int lane = 0; lane < 4; lane++) {
            double value = z_range[2 * quadric[lane] + side];
            AT(z, lane) = isfinite(value) ? value : 0.0;
            AT(c, lane) = radii[3 * quadric[lane] + 2];
        }
        dd height = dd_div(dd_from(z), dd_from(c));
        end[side] = fabs(height.hi);
        for (int k = 0; k < LINEAR; k++)
            range[side][k] = orthographic ? f.moving[k][2] : k == 2 ? f.fixed[2] : zero;
        range[side][2] = dd_sub(range[side][2], height);
        linear_form e[4];
        for (int k = 0; k < LINEAR; k++) {
            e[0].c[k] = dd_sub(l[1].c[k], dd_mul(height, l[3].c[k]));
            e[1].c[k] = dd_sub(l[2].c[k], dd_mul(height, l[4].c[k]));
            e[2].c[k] = dd_neg(dd_mul(height, l[5].c[k]));
            e[3].c[k] = dd_neg(l[5].c[k]);
        }
        for (int k = 0; k < QUADRATIC; k++)
            cap[side].c[k] = zero;
        for (int i = 0; i < 4; i++)
            for (int j = i; j < 4; j++) {
                dd d = form[upper(i, j)];
                if (nonzero(d))
                    add_product(&cap[side], dd_scale(d, (double4)(i == j ? 1.0 : 2.0)), &e[i], &e[j]);
            }
    }

    quadratic_form fixed_form;
    for (int k = 0; k < QUADRATIC; k++)
        fixed_form.c[k] = zero;
    fixed_form.c[5] = ff;
    for (int lane = 0; lane < 4 && first + lane < count; lane++) {
        int q = quadric[lane];
        __global general_record *r = records + first + lane;
        store(r->s, s.c, QUADRATIC, lane);
        store(r->a, orthographic ? fixed_form.c : vv.c, QUADRATIC, lane);
        store(r->b, fv, LINEAR, lane);
        store(r->c, orthographic ? vv.c : fixed_form.c, QUADRATIC, lane);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < LINEAR; k++) {
                double fixed = k == 2 ? AT(f.fixed[i].hi, lane) : 0.0;
                double moving = AT(f.moving[k][i].hi, lane);
                r->x[i][k] = orthographic ? moving : fixed;
                r->y[i][k] = orthographic ? fixed : moving;
                // l is F ^ V; moments are X ^ Y.
                r->moment[i][k] = (orthographic ? -1.0 : 1.0) * AT(l[i].c[k].hi, lane);
            }
        for (int side = 0; side < 2; side++) {
            store(r->range[side], range[side], LINEAR, lane);
            r->end[side] = AT(end[side], lane);
            store(r->cap[side], cap[side].c, QUADRATIC, lane);
        }
        store(r->form, form, 10, lane);
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                r->normal[j][k] = target[j] * AT(f.map[k][0].hi, lane) + target[3 + j] * AT(f.map[k][1].hi, lane) +
                                  target[6 + j] * AT(f.map[k][2].hi, lane);
        r->kappa = AT(f.kappa, lane);
        r->fixed_norm = AT(f.fixed_norm, lane);
        for (int k = 0; k < LINEAR; k++)
            r->moving_norm[k] = AT(f.moving_norm[k], lane);
        r->form_sum = AT(form_sum, lane);
        for (int k = 0; k < LINEAR; k++) {
            double sum = 0.0;
            for (int p = 0; p < 6; p++)
                sum += AT(l[p].c[k].hi, lane) * AT(l[p].c[k].hi, lane);
            r->moment_norm[k] = sqrt(sum);
        }
        r->spatial_sum = AT(spatial_sum, lane);
        r->compound_sum = AT(compound_sum, lane);
        r->centre[0] = middle[q].x;
        r->centre[1] = middle[q].y;
        r->flags = form_flags[q] | (isfinite(z_range[2 * q]) ? HAS_RANGE : 0) | (capped[q] ? HAS_CAPS : 0) |
                   (z_range[2 * q] == z_range[2 * q + 1] ? FLAT : 0) | (orthographic ? ORTHOGRAPHIC : 0);
        r->clip_start = clip_start[q];
        r->clip_count = clip_start[q + 1] - clip_start[q];
    }
}

__kernel void set_up_clips(int count, __global const double *plane, __global const double *rays, double unit,
                           __global clip_record *records)
{
    int first = 4 * get_global_id(0);
    double4 n[4];
    for (int lane = 0; lane < 4; lane++)
        for (int k = 0; k < 4; k++)
            AT(n[k], lane) = plane[4 * min(first + lane, count - 1) + k];
    for (int part = 0; part < 6; part++) {
        dd sum = dd_from(part == 0 ? n[3] : (double4)(0.0));
        for (int k = 0; k < 3; k++)
            sum = dd_add(sum, dd_scale(ray_part(rays, part, k), n[k]));
        for (int lane = 0; lane < 4 && first + lane < count; lane++) {
            __global double *form = part < 3 ? records[first + lane].offset : records[first + lane].slope;
            form[(part + 2) % 3] = AT(sum.hi, lane) * (part < 3 ? 1.0 : unit);
        }
    }
}
