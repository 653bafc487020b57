// Records of the closed surfaces wholly in front of the camera, in double-double.

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void set_up_simple(int count, __global const int *rows, __global const int *list, __global const double *world_from_object,
                   __global const double *radii, __global const int2 *middle, __global const double *rays, double unit,
                   int orthographic, __global const double *target, __global const int4 *box, int4 crop,
                   __global simple_record *records, __global simple_normal_record *normals)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int row[4], quadric[4], open[4];
    moments m;
    for (int lane = 0; lane < 4; lane++) {
        row[lane] = rows[min(first + lane, count - 1)];
        quadric[lane] = list[row[lane]];
        m.centre[lane] = middle[quadric[lane]];
    }
    family f;
    family_of(quadric, m.centre, world_from_object, radii, rays, unit, orthographic, &f);
    double4 reach[LINEAR];
    reach_of(quadric, m.centre, box, crop, reach);

    m.ff = dd_sub(dd_dot3(f.fixed, f.fixed), dd_mul(f.fixed[3], f.fixed[3])).hi;
    const int first_of[6] = {0, 0, 1, 0, 1, 2}, second_of[6] = {1, 2, 2, 3, 3, 3};
    for (int p = 0; p < 6; p++) {
        linear_form form = pluecker(&f, first_of[p], second_of[p]);
        for (int k = 0; k < LINEAR; k++)
            m.l[p][k] = form.c[k].hi;
    }
    double4 farthest = (double4)(0.0);
    for (int k = 0; k < LINEAR; k++) {
        m.fv[k] = dd_sub(dd_dot3(f.fixed, f.moving[k]), dd_mul(f.fixed[3], f.moving[k][3])).hi;
        for (int i = 0; i < 4; i++)
            m.moving[k][i] = f.moving[k][i].hi;
        farthest += reach[k] * f.moving_norm[k];
    }
    for (int i = 0; i < 4; i++)
        m.fixed[i] = f.fixed[i].hi;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m.map[i][j] = f.map[i][j].hi;
    m.map_unit = f.map_unit;
    m.map_norm = f.map_norm;
    m.fixed_size = f.fixed_norm;
    // Every number of the family is within 2^-98 kappa of its size; six moments of two products each, sums of four.
    double4 unit_lost = 0x1p-98 * f.kappa;
    m.l_lost = 8.0 * unit_lost * f.fixed_norm * farthest;
    m.fv_lost = 8.0 * unit_lost * f.fixed_norm * farthest;
    m.ff_lost = 8.0 * unit_lost * f.fixed_norm * f.fixed_norm;
    m.map_lost = unit_lost;
    for (int lane = 0; lane < 4; lane++)
        m.in_range[lane] = f.in_range[lane];
    write_simple(&m, reach, quadric, row, min(4, count - first), orthographic, target, box, crop, records, normals, open);
}
