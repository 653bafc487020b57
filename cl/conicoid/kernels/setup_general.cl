// Records of every other quadric, and of the clip planes.

static inline void store(__global double *out, const dd *values, int count, int lane)
{
    for (int k = 0; k < count; k++)
        out[k] = ((__private const double *)&values[k].hi)[lane];
}

static inline int nonzero(dd x) { return any(x.hi != (double4)(0.0)); }

static inline double largest(__global const double *c, int count)
{
    double size = 0.0;
    for (int k = 0; k < count; k++)
        size = fmax(size, fabs(c[k]));
    return size;
}

// More often than not exactly zero: a paraboloid seen along its axis has a = 0 at every pixel, an eye on a surface c = 0,
// a cylinder seen end-on both b = 0 and S = 0.
static int drowned(__global const general_record *r)
{
    int orthographic = r->flags & ORTHOGRAPHIC;
    double x = orthographic ? r->moving_norm[2] : r->fixed_norm, y = orthographic ? r->fixed_norm : r->moving_norm[2];
    double unit = 0x1p-89 * r->kappa;
    return r->spatial_sum > 0.0 &&
           (largest(r->a, QUADRATIC) <= unit * r->spatial_sum * y * y ||
            largest(r->b, LINEAR) <= unit * r->form_sum * x * y || largest(r->c, QUADRATIC) <= unit * r->form_sum * x * x ||
            largest(r->s, QUADRATIC) <= unit * r->compound_sum * (2.0 * largest(r->moment_norm, LINEAR) + unit * x * y) * x * y);
}

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
    int2 centre[4];
    quads_of(list, middle, count, first, quadric, centre);
    family f;
    family_of(quadric, centre, world_from_object, radii, rays, unit, orthographic, &f);

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
                r->normal[j][k] = AT(f.map_unit, lane) *
                                  (target[j] * AT(f.map[k][0].hi, lane) + target[3 + j] * AT(f.map[k][1].hi, lane) +
                                   target[6 + j] * AT(f.map[k][2].hi, lane));
        int in_range = f.in_range[lane];
        for (int k = 0; k < QUADRATIC; k++)
            in_range &= workable(r->s[k]) & workable(r->a[k]) & workable(r->c[k]) & workable(r->cap[0][k]) &
                        workable(r->cap[1][k]);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < LINEAR; k++)
                in_range &= workable(r->x[i][k]) & workable(r->y[i][k]) & workable(r->moment[i][k]) & workable(r->b[k]);
        r->kappa = in_range ? AT(f.kappa, lane) : INFINITY;
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
        r->centre[0] = centre[lane].x;
        r->centre[1] = centre[lane].y;
        r->flags = form_flags[q] | (isfinite(z_range[2 * q]) ? HAS_RANGE : 0) | (capped[q] ? HAS_CAPS : 0) |
                   (z_range[2 * q] == z_range[2 * q + 1] ? FLAT : 0) | (orthographic ? ORTHOGRAPHIC : 0);
        r->placed = 0;
        r->drowned = drowned(r);
        for (int kind = 0; kind < 4; kind++) {
            r->clip_start[kind] = clip_start[q];
            r->clip_count[kind] = clip_start[q + 1] - clip_start[q];
        }
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
