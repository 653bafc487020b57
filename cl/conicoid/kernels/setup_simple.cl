// Records of the closed surfaces wholly in front of the camera.

// Ellipsoids: D = diag(1, 1, 1, -1), so S = |V4 F - F4 V|^2 - |F x V|^2 with no cancellation but the silhouette's
// own; from the double-double forms on, binary64 loses nothing that casting would keep.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void set_up_simple(int count, __global const int *list, __global const double *world_from_object,
                   __global const double *radii, __global const int2 *middle, __global const double *rays, double unit,
                   int orthographic, __global const double *target, __global const int4 *box,
                   int4 crop, __global simple_record *records, __global simple_normal_record *normals)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int quadric[4];
    int2 centre[4];
    quads_of(list, middle, count, first, quadric, centre);
    family f;
    family_of(quadric, centre, world_from_object, radii, rays, unit, orthographic, &f);

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
            n[j][k] = -(f.map[0][j].hi * w[0] + f.map[1][j].hi * w[1] + f.map[2][j].hi * w[2]) * f.map_unit / ff;
    }
    for (int j = 0; j < 3; j++)
        g[j] = root_sign * f.map_unit *
               (f.map[0][j].hi * f.fixed[0].hi + f.map[1][j].hi * f.fixed[1].hi + f.map[2][j].hi * f.fixed[2].hi);
    for (int k = 0; k < QUADRATIC; k++)
        s[k] = (s[k] / ff) / ff;

    // The conic's highest value, where it is an ellipse.
    double4 bend = 4.0 * s[0] * s[2] - s[1] * s[1];
    double4 summit = s[5] + (s[1] * s[3] * s[4] - s[2] * s[3] * s[3] - s[0] * s[4] * s[4]) / bend;
    // Sums of the terms' magnitudes at the farthest pixel, where (|u|, |v|, 1) is `reach`: expanded in the moments l, those
    // of S add up to l_norm^2 at most, those of b to b_norm, those of the vector n to n_norm in length. Casting looks at
    // whole tiles. Beyond the box of a whole, small ellipse, though, S falls faster than its error grows: at rho times the
    // way from its middle to its rim S is summit (1 - rho^2), the error at most (2 rho - 1)^2 times that of the box, and
    // boxes leave a millionth to the rim.
    double4 reach[LINEAR] = {(double4)(0.0), (double4)(0.0), (double4)(1.0)};
    int whole[4];
    for (int lane = 0; lane < 4; lane++) {
        int4 b = box[quadric[lane]];
        int2 c = centre[lane];
        whole[lane] = b.x > crop.x && b.y > crop.y && b.z < crop.z && b.w < crop.w && max(b.z - b.x, b.w - b.y) < 4 * TILE;
        int margin = whole[lane] ? 0 : TILE;
        AT(reach[0], lane) = max(abs(b.x - c.x), abs(b.z - c.x)) + margin;
        AT(reach[1], lane) = max(abs(b.y - c.y), abs(b.w - c.y)) + margin;
    }
    double4 f_norm = (double4)(0.0), l_norm = f_norm, v_norm = f_norm, v_lost = f_norm;
    for (int k = 0; k < LINEAR; k++)
        v_lost += reach[k] * f.moving_norm[k];
    // What double-double lost, 2^-97 of this, widens moments: 2 |l| d + d^2 <= 2^-48 ((|l| + 2^48 d)^2 - |l|^2).
    double4 lost = f.kappa * f.fixed_norm * v_lost;
    for (int p = 0; p < 6; p++) {
        double4 moment = 0x1p-49 * lost;
        for (int k = 0; k < LINEAR; k++)
            moment += reach[k] * fabs(l[p][k]);
        l_norm += moment * moment;
    }
    for (int i = 0; i < 4; i++) {
        double4 moving = (double4)(0.0);
        for (int k = 0; k < LINEAR; k++)
            moving += reach[k] * fabs(f.moving[k][i].hi);
        f_norm += f.fixed[i].hi * f.fixed[i].hi;
        v_norm += moving * moving;
    }
    f_norm = sqrt(f_norm);
    l_norm = sqrt(l_norm) / fabs(ff);
    double4 b_norm = (f_norm * sqrt(v_norm) + 0x1p-44 * lost) / fabs(ff);
    double4 map_norm = f.map_unit * f.map_norm;
    double4 g_norm = map_norm * (f_norm + 0x1p-44 * f.kappa * f.fixed_norm);
    double4 n_norm = map_norm * f_norm * l_norm;
    // Roundings that a term passes through at most. S: 12 in set-up (moments, sums, divisions by a rounded F'DF), 5 in
    // evaluation, 1 in raising it. b: 3 and 3, and 2 in the key. n: 15 and 4, g sqrt(S) fewer.
    double4 s_error = 20.0 * UNIT_ROUNDOFF * l_norm * l_norm;
    double4 key_error = UNIT_ROUNDOFF * (9.0 * b_norm + 4.0 * l_norm);
    double4 n_error = 21.0 * UNIT_ROUNDOFF * (n_norm + g_norm * l_norm);
    // An eye so near the surface that F'DF itself is in doubt: exact arithmetic takes over.
    double4 certain = 0x1p-38 * f.kappa * f.fixed_norm * f.fixed_norm;

    // Normals to unit length at the centre: binary32 casting squares them.
    double4 length = (double4)(0.0);
    for (int j = 0; j < 3; j++)
        length += n[j][2] * n[j][2] + g[j] * g[j] * fabs(s[5]);
    length = 1.0 / sqrt(length);
    for (int lane = 0; lane < 4 && first + lane < count; lane++) {
        __global simple_record *r = records + first + lane;
        __global simple_normal_record *m = normals + first + lane;
        double scale = AT(length, lane);
        scale = isfinite(scale) ? scale : 1.0;
        int in_range = f.in_range[lane] & (fabs(AT(ff, lane)) > AT(certain, lane));
        // Nor is a rim that the errors blur by as much as a box leaves.
        in_range &= !whole[lane] | (AT(bend, lane) > 0.0 && AT(summit, lane) > 0x1p22 * AT(s_error, lane));
        for (int k = 0; k < QUADRATIC; k++)
            in_range &= workable(AT(s[k], lane)) & workable(k < LINEAR ? AT(b[k], lane) : 0.0);
        for (int p = 0; p < 6; p++)
            for (int k = 0; k < LINEAR; k++)
                in_range &= workable(AT(l[p][k], lane));
        for (int k = 0; k < QUADRATIC; k++)
            r->s[k] = AT(s[k], lane);
        for (int k = 0; k < LINEAR; k++)
            r->b[k] = AT(b[k], lane);
        r->s_error = in_range ? AT(s_error, lane) : INFINITY;
        r->slop = AT(key_error, lane) + sqrt(2.0 * r->s_error) * (1.0 + 4.0 * UNIT_ROUNDOFF);
        r->centre[0] = centre[lane].x;
        r->centre[1] = centre[lane].y;
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < LINEAR; k++)
                m->n[j][k] = scale * (target[j] * AT(n[0][k], lane) + target[3 + j] * AT(n[1][k], lane) + target[6 + j] * AT(n[2][k], lane));
            m->g[j] = scale * (target[j] * AT(g[0], lane) + target[3 + j] * AT(g[1], lane) + target[6 + j] * AT(g[2], lane));
        }
        // A target frame is a rotation within 1e-6.
        m->key_error = AT(key_error, lane);
        m->n_error = 1.01 * scale * AT(n_error, lane);
        m->g_norm = 1.01 * sqrt(m->g[0] * m->g[0] + m->g[1] * m->g[1] + m->g[2] * m->g[2]) +
                    0x1p-30 * scale * AT(g_norm, lane);
    }
}
