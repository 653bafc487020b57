// Records of the closed surfaces wholly in front of the camera, in double-double: of rows of `list` that are left.

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void set_up_simple(int count, __global const int *rows, __global const int *list, __global const int *slot_of,
                   __global const double *world_from_object, __global const double *radii, __global const int2 *middle,
                   __global const double *rays, double unit, int orthographic, double2 principal, double4 axis,
                   __global const int4 *box, int4 crop, __global const float *nearest, __global slot_record *slots)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int quadric[4], open[4];
    moments m;
    for (int lane = 0; lane < 4; lane++) {
        quadric[lane] = list[rows[min(first + lane, count - 1)]];
        m.centre[lane] = middle[quadric[lane]];
    }
    family f;
    family_of(quadric, m.centre, world_from_object, radii, rays, unit, orthographic, &f);

    m.ff = dd_sub(dd_dot3(f.fixed, f.fixed), dd_mul(f.fixed[3], f.fixed[3])).hi;
    const int first_of[6] = {0, 0, 1, 0, 1, 2}, second_of[6] = {1, 2, 2, 3, 3, 3};
    for (int p = 0; p < 6; p++) {
        linear_form form = pluecker(&f, first_of[p], second_of[p]);
        for (int k = 0; k < LINEAR; k++)
            m.l[p][k] = form.c[k].hi;
    }
    // Every number of the family is within 2^-98 kappa of its size; six moments of two products each, sums of four.
    double4 lost = 0x1p-95 * f.kappa * f.fixed_norm;
    m.ff_lost = lost * f.fixed_norm;
    for (int k = 0; k < LINEAR; k++) {
        m.fv[k] = dd_sub(dd_dot3(f.fixed, f.moving[k]), dd_mul(f.fixed[3], f.moving[k][3])).hi;
        m.l_lost[k] = m.fv_lost[k] = lost * f.moving_norm[k];
        for (int i = 0; i < 4; i++)
            m.moving[k][i] = f.moving[k][i].hi;
    }
    for (int i = 0; i < 4; i++) {
        m.fixed[i] = f.fixed[i].hi;
        ((__private long *)&m.in_range)[i] = f.in_range[i] ? -1 : 0;
    }
    bounds_frame frame = {crop, orthographic, principal, {axis.x, axis.y, axis.z}};
    write_simple(&m, quadric, slot_of, min(4, count - first), &frame, box, nearest, slots, open);
}
