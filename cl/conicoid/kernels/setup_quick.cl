// Records of the closed surfaces wholly in front of the camera, in binary64 but for the one thing that cancels: the moment
// of the ray through the quadric's own middle, p x d, is small beside p and d by the quadric's size over its distance.
// All else has errors of some hundred u whatever the distance; what has more is left to double-double.

// 3-vectors: the cross product's error is at most 3u |a| |b|.
static inline void cross3(const double4 *a, const double4 *b, double4 *out)
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static inline double4 length3(const double4 *a) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void set_up_quickly(int count, __global const int *list, __global const int *slot_of,
                    __global const double *world_from_object, __global const double *radii, __global const int2 *middle,
                    __global const double *rays, double unit, int orthographic, double2 principal, double4 axis,
                    __global const int4 *box, int4 crop, __global const float *nearest, __global slot_record *slots,
                    __global uchar *open_rows)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int quadric[4], open[4];
    moments m;
    double4 a[3][4], r[3], u, v;
    for (int lane = 0; lane < 4; lane++) {
        int q = quadric[lane] = list[min(first + lane, count - 1)];
        m.centre[lane] = middle[q];
        AT(u, lane) = m.centre[lane].x;
        AT(v, lane) = m.centre[lane].y;
        for (int k = 0; k < 12; k++)
            AT(a[k / 4][k % 4], lane) = world_from_object[12 * q + k];
        for (int k = 0; k < 3; k++)
            AT(r[k], lane) = radii[3 * q + k];
    }

    // diag(1/radii) M^-1 as adj(M) / (det(M) radii). With K = |M|^3 / |det M| at least the ratio of any two semi-axes of M,
    // entries of the adjugate are within 3u |M|^2, the determinant within 6u |M|^3, so the map within 12 K u of its norm.
    double4 map[3][3], adjugate[3][3], spread = (double4)(0.0), rows_norm = spread, determinant = spread;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int p = (i + 1) % 3, q = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
            adjugate[j][i] = a[p][s] * a[q][t] - a[p][t] * a[q][s];
            spread += a[i][j] * a[i][j];
        }
    for (int j = 0; j < 3; j++)
        determinant += adjugate[j][0] * a[0][j];
    double4 per_determinant = 1.0 / determinant, K = spread * sqrt(spread) * fabs(per_determinant);
    for (int i = 0; i < 3; i++) {
        double4 scale = per_determinant / r[i];
        for (int j = 0; j < 3; j++) {
            map[i][j] = adjugate[i][j] * scale;
            rows_norm += map[i][j] * map[i][j];
        }
    }
    double4 map_norm = sqrt(rows_norm);

    // The ray through the middle, point + t direction in the world: in double-double.
    dd point[3], direction[3];
    double4 part[2][3], lost_size = (double4)(0.0);     // u and v parts of what moves
    for (int k = 0; k < 3; k++) {
        int moving = orthographic ? 1 : 4;
        dd shift = dd_add(dd_scale(ray_part(rays, moving, k), u), dd_scale(ray_part(rays, moving + 1, k), v));
        point[k] = dd_sub(ray_part(rays, 0, k), dd_from(a[k][3]));
        direction[k] = ray_part(rays, 3, k);
        if (orthographic)
            point[k] = dd_add(point[k], shift);
        else
            direction[k] = dd_add(direction[k], shift);
        direction[k].hi *= unit;
        direction[k].lo *= unit;
        for (int axis = 0; axis < 2; axis++)
            part[axis][k] = ray_part(rays, moving + axis, k).hi * (orthographic ? 1.0 : unit);
        // What the middle was summed from, whose parts are within 2^-104.
        lost_size += fabs(part[0][k] * u) + fabs(part[1][k] * v) +
                     fabs(ray_part(rays, orthographic ? 0 : 3, k).hi * (orthographic ? 1.0 : unit));
    }
    dd *fixed = orthographic ? direction : point, *other = orthographic ? point : direction;
    double4 fixed_world[3], cross[LINEAR][3];
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        cross[2][k] = dd_minor(fixed[i], other[j], fixed[j], other[i]).hi;
        fixed_world[k] = fixed[k].hi;
    }
    cross3(fixed_world, part[0], cross[0]);
    cross3(fixed_world, part[1], cross[1]);

    // In parameter space: (A x) x (A y) = cof(A) (x x y), cof(A) = diag(radii) M^T / (det(M) r1 r2 r3).
    double4 volume = per_determinant / (r[0] * r[1] * r[2]), cofactor_norm = (double4)(0.0);
    const int place[3] = {2, 1, 0};     // L23, L13, L12, the second with its sign turned
    for (int i = 0; i < 3; i++) {
        double4 scale = (i == 1 ? -volume : volume) * r[i];
        for (int k = 0; k < LINEAR; k++)
            m.l[place[i]][k] = (a[0][i] * cross[k][0] + a[1][i] * cross[k][1] + a[2][i] * cross[k][2]) * scale;
        double4 column = (a[0][i] * a[0][i] + a[1][i] * a[1][i] + a[2][i] * a[2][i]) * scale * scale;
        cofactor_norm += column;
    }
    cofactor_norm = sqrt(cofactor_norm);
    for (int i = 0; i < 3; i++) {
        m.fixed[i] = map[i][0] * fixed_world[0] + map[i][1] * fixed_world[1] + map[i][2] * fixed_world[2];
        m.moving[2][i] = map[i][0] * other[0].hi + map[i][1] * other[1].hi + map[i][2] * other[2].hi;
        for (int axis = 0; axis < 2; axis++)
            m.moving[axis][i] = map[i][0] * part[axis][0] + map[i][1] * part[axis][1] + map[i][2] * part[axis][2];
        // F4 = 1 and V4 = 0 for a pinhole, the other way round for parallel rays.
        for (int k = 0; k < LINEAR; k++)
            m.l[3 + i][k] = orthographic ? (k == 2 ? m.fixed[i] : (double4)(0.0)) : -m.moving[k][i];
    }
    m.fixed[3] = (double4)(orthographic ? 0.0 : 1.0);
    for (int k = 0; k < LINEAR; k++) {
        m.moving[k][3] = (double4)(orthographic && k == 2 ? 1.0 : 0.0);
        m.fv[k] = m.fixed[0] * m.moving[k][0] + m.fixed[1] * m.moving[k][1] + m.fixed[2] * m.moving[k][2];
    }
    m.ff = m.fixed[0] * m.fixed[0] + m.fixed[1] * m.fixed[1] + m.fixed[2] * m.fixed[2] - m.fixed[3] * m.fixed[3];

    double4 other_world[3] = {other[0].hi, other[1].hi, other[2].hi};
    double4 fixed_length = length3(fixed_world), other_length = length3(other_world);
    double4 map_lost = (12.0 * K + 8.0) * UNIT_ROUNDOFF;
    double4 fixed_size = map_norm * fixed_length + (orthographic ? 0.0 : 1.0);
    // The cofactors are within (6K + 8)u; crosses of what moves within 6u of the factors, that of the middle within 2^-98.
    for (int k = 0; k < LINEAR; k++) {
        double4 moving_length = k < 2 ? length3(part[k]) : other_length;
        double4 crossed = k < 2 ? 6.0 * UNIT_ROUNDOFF * fixed_length * moving_length
                                : 0x1p-98 * fixed_length * (other_length + lost_size);
        m.l_lost[k] = cofactor_norm * ((6.0 * K + 12.0) * UNIT_ROUNDOFF * length3(cross[k]) + crossed);
        m.l_lost[k] += map_lost * map_norm * (orthographic ? (k == 2 ? fixed_length : (double4)(0.0)) : moving_length);
        m.fv_lost[k] = 3.0 * map_lost * fixed_size * map_norm * moving_length;
    }
    m.ff_lost = 3.0 * map_lost * fixed_size * fixed_size;
    m.in_range = all_workable(determinant) & all_workable(volume) & all_workable(K);
    for (int k = 0; k < 9; k++)
        m.in_range &= all_workable(map[k / 3][k % 3]) & all_workable(a[k / 3][k % 3]);
    for (int k = 0; k < 3; k++)
        m.in_range &= all_workable(r[k]) & all_workable(fixed_world[k]) & all_workable(other_world[k]);
    int lanes = min(4, count - first);
    bounds_frame frame = {crop, orthographic, principal, {axis.x, axis.y, axis.z}};
    write_simple(&m, quadric, slot_of, lanes, &frame, box, nearest, slots, open);
    for (int lane = 0; lane < lanes; lane++)
        open_rows[first + lane] = open[lane];
}
