// Records of the closed surfaces wholly in front of the camera.

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
            n[j][k] = -(f.map[0][j].hi * w[0] + f.map[1][j].hi * w[1] + f.map[2][j].hi * w[2]) * f.map_unit / ff;
    }
    for (int j = 0; j < 3; j++)
        g[j] = root_sign * f.map_unit *
               (f.map[0][j].hi * f.fixed[0].hi + f.map[1][j].hi * f.fixed[1].hi + f.map[2][j].hi * f.fixed[2].hi);
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
        n_norm[k] = certain * f.map_unit * f.map_norm * f_norm * moment / fabs(ff);
    }
    double4 g_norm = f.map_unit * f.map_norm * (f_norm + 0x1p-44 * f.kappa * f.fixed_norm);

    // Normals to unit length at the centre: binary32 casting squares them.
    double4 length = (double4)(0.0);
    for (int j = 0; j < 3; j++)
        length += n[j][2] * n[j][2] + g[j] * g[j] * fabs(s[5]);
    length = 1.0 / sqrt(length);
    for (int lane = 0; lane < 4 && first + lane < count; lane++) {
        __global simple_record *r = records + first + lane;
        double scale = AT(length, lane);
        scale = isfinite(scale) ? scale : 1.0;
        int in_range = f.in_range[lane];
        for (int k = 0; k < QUADRATIC; k++)
            in_range &= workable(AT(s[k], lane)) & workable(k < LINEAR ? AT(b[k], lane) : 0.0);
        for (int p = 0; p < 6; p++)
            for (int k = 0; k < LINEAR; k++)
                in_range &= workable(AT(l[p][k], lane));
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
            r->s_norm[k] = in_range ? AT(s_norm[k], lane) : INFINITY;
            r->b_norm[k] = AT(b_norm[k], lane);
            r->n_norm[k] = 2.0 * scale * AT(n_norm[k], lane);
        }
        r->g_norm = 2.0 * scale * AT(g_norm, lane);
        r->centre[0] = middle[quadric[lane]].x;
        r->centre[1] = middle[quadric[lane]].y;
    }
}
