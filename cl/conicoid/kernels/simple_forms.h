// From an ellipsoid's moments along the rays to its record: what both ways of setting it up share.
//
// D = diag(1, 1, 1, -1), so S = |V4 F - F4 V|^2 - |F x V|^2 with no cancellation but the silhouette's own: once the
// moments are known, binary64 loses nothing that casting would keep.

// Four quadrics' rays in parameter space, to binary64, and bounds of what was lost before.
typedef struct {
    int2 centre[4];
    double4 fixed[4], moving[LINEAR][4];
    double4 l[6][LINEAR];       // L12 L13 L23 L14 L24 L34, Lij = Fi Vj - Fj Vi
    double4 ff, fv[LINEAR];     // F'DF, F'DV
    double4 map[3][3], map_unit, map_norm;
    double4 fixed_size;         // of F before anything cancelled
    // Lost: the length of all moments' errors at the farthest pixel of the box, the error of F'DV there, and of F'DF; of
    // the map and of F relative to map_norm and fixed_size.
    double4 l_lost, fv_lost, ff_lost, map_lost;
    int in_range[4];
} moments;

// The farthest pixel of each box from its centre, (|u|, |v|, 1). Casting looks at whole tiles. Beyond the box of a whole,
// small ellipse, though, S falls faster than its error grows: at rho times the way from its middle to its rim S is
// summit (1 - rho^2), the error at most (2 rho - 1)^2 times that of the box, and boxes leave a millionth to the rim.
static inline int whole_ellipse(int4 box, int4 crop)
{
    return box.x > crop.x && box.y > crop.y && box.z < crop.z && box.w < crop.w &&
           max(box.z - box.x, box.w - box.y) < 4 * TILE;
}

static void reach_of(const int *quadric, const int2 *centre, __global const int4 *box, int4 crop, double4 *reach)
{
    reach[2] = (double4)(1.0);
    for (int lane = 0; lane < 4; lane++) {
        int4 b = box[quadric[lane]];
        int margin = whole_ellipse(b, crop) ? 0 : TILE;
        AT(reach[0], lane) = max(abs(b.x - centre[lane].x), abs(b.z - centre[lane].x)) + margin;
        AT(reach[1], lane) = max(abs(b.y - centre[lane].y), abs(b.w - centre[lane].y)) + margin;
    }
}

// Writes up to `lanes` records; open[lane] tells which of them are not known well enough to be worth casting.
static void write_simple(const moments *m, const double4 *reach, const int *quadric, const int *row, int lanes,
                         int orthographic, __global const double *target, __global const int4 *box, int4 crop,
                         __global simple_record *records, __global simple_normal_record *normals, int *open)
{
    double4 s[QUADRATIC];
    for (int k = 0; k < QUADRATIC; k++)
        s[k] = (double4)(0.0);
    for (int p = 0; p < 6; p++) {
        double4 sign = p < 3 ? (double4)(-1.0) : (double4)(1.0);
        double4 x = sign * m->l[p][0], y = sign * m->l[p][1], z = sign * m->l[p][2];
        s[0] = fma(x, m->l[p][0], s[0]);
        s[1] = fma(2.0 * x, m->l[p][1], s[1]);
        s[2] = fma(y, m->l[p][1], s[2]);
        s[3] = fma(2.0 * x, m->l[p][2], s[3]);
        s[4] = fma(2.0 * y, m->l[p][2], s[4]);
        s[5] = fma(z, m->l[p][2], s[5]);
    }
    // Pinhole: key = s = -b/c + sqrt(S)/|c|, on X + Y/s. Orthographic: key = -t = b/a + sqrt(S)/a.
    double4 b[LINEAR], n[3][LINEAR], g[3], per_ff = 1.0 / m->ff;
    double4 root_sign = orthographic ? (double4)(-1.0) : (double4)(1.0);
    for (int k = 0; k < LINEAR; k++) {
        b[k] = -root_sign * m->fv[k] * per_ff;
        // D(V - (b/ff) F) without its cancellation: -sum_k (DF)_k L_ik / ff.
        double4 w[3];
        w[0] = m->fixed[1] * m->l[0][k] + m->fixed[2] * m->l[1][k] - m->fixed[3] * m->l[3][k];
        w[1] = -m->fixed[0] * m->l[0][k] + m->fixed[2] * m->l[2][k] - m->fixed[3] * m->l[4][k];
        w[2] = -m->fixed[0] * m->l[1][k] - m->fixed[1] * m->l[2][k] - m->fixed[3] * m->l[5][k];
        for (int j = 0; j < 3; j++)
            n[j][k] = -(m->map[0][j] * w[0] + m->map[1][j] * w[1] + m->map[2][j] * w[2]) * m->map_unit * per_ff;
    }
    for (int j = 0; j < 3; j++)
        g[j] = root_sign * m->map_unit *
               (m->map[0][j] * m->fixed[0] + m->map[1][j] * m->fixed[1] + m->map[2][j] * m->fixed[2]);
    for (int k = 0; k < QUADRATIC; k++)
        s[k] = (s[k] * per_ff) * per_ff;

    // The conic's highest value, where it is an ellipse.
    double4 bend = 4.0 * s[0] * s[2] - s[1] * s[1];
    double4 summit = s[5] + (s[1] * s[3] * s[4] - s[2] * s[3] * s[3] - s[0] * s[4] * s[4]) / bend;
    // Sums of the terms' magnitudes at the farthest pixel: expanded in the moments l, those of S add up to l_norm^2 at
    // most, those of b to b_norm, those of the vector n to n_norm in length.
    double4 f_norm = (double4)(0.0), l_norm = f_norm, v_norm = f_norm;
    for (int p = 0; p < 6; p++) {
        double4 moment = reach[0] * fabs(m->l[p][0]) + reach[1] * fabs(m->l[p][1]) + fabs(m->l[p][2]);
        l_norm += moment * moment;
    }
    for (int i = 0; i < 4; i++) {
        double4 moving = reach[0] * fabs(m->moving[0][i]) + reach[1] * fabs(m->moving[1][i]) + fabs(m->moving[2][i]);
        f_norm += m->fixed[i] * m->fixed[i];
        v_norm += moving * moving;
    }
    double4 per_size = fabs(per_ff), skew = m->ff_lost * per_size;
    f_norm = sqrt(f_norm);
    l_norm = sqrt(l_norm) * per_size;
    double4 b_norm = f_norm * sqrt(v_norm) * per_size, lost = m->l_lost * per_size;
    double4 map_norm = m->map_unit * m->map_norm;
    double4 n_norm = map_norm * f_norm * l_norm, g_norm = map_norm * f_norm;
    // Roundings that a term passes through at most. S: 14 in set-up (moments, sums, products by a rounded 1/F'DF), 5 in
    // evaluation, 1 in raising it. b: 4 and 3, and 2 in the key. n: 16 and 4, g sqrt(S) fewer.
    double4 s_error = 22.0 * UNIT_ROUNDOFF * l_norm * l_norm + (2.0 * l_norm + lost) * lost + 2.5 * skew * l_norm * l_norm;
    double4 key_error = UNIT_ROUNDOFF * (10.0 * b_norm + 4.0 * l_norm) + m->fv_lost * per_size + 1.25 * skew * b_norm;
    double4 n_error = (22.0 * UNIT_ROUNDOFF + 1.25 * skew) * (n_norm + g_norm * l_norm) +
                      map_norm * (f_norm * lost + 4.0 * m->map_lost * m->fixed_size * l_norm);

    // Normals to unit length at the centre: binary32 casting squares them.
    double4 length = (double4)(0.0);
    for (int j = 0; j < 3; j++)
        length += n[j][2] * n[j][2] + g[j] * g[j] * fabs(s[5]);
    length = 1.0 / sqrt(length);
    for (int lane = 0; lane < lanes; lane++) {
        __global simple_record *r = records + row[lane];
        __global simple_normal_record *o = normals + row[lane];
        double scale = AT(length, lane);
        scale = isfinite(scale) ? scale : 1.0;
        int in_range = m->in_range[lane];
        for (int k = 0; k < QUADRATIC; k++)
            in_range &= workable(AT(s[k], lane)) & workable(k < LINEAR ? AT(b[k], lane) : 0.0);
        for (int p = 0; p < 6; p++)
            for (int k = 0; k < LINEAR; k++)
                in_range &= workable(AT(m->l[p][k], lane));
        // An eye so near the surface that F'DF itself is in doubt.
        in_range &= AT(skew, lane) < 0x1p-20;
        // Nor is a rim that the errors blur by as much as a box leaves.
        int ellipse = AT(bend, lane) > 0.0;
        in_range &= !whole_ellipse(box[quadric[lane]], crop) | (ellipse && AT(summit, lane) > 0x1p22 * AT(s_error, lane));
        open[lane] = !in_range | !(ellipse && AT(summit, lane) > 0x1p32 * AT(s_error, lane));
        for (int k = 0; k < QUADRATIC; k++)
            r->s[k] = AT(s[k], lane);
        for (int k = 0; k < LINEAR; k++)
            r->b[k] = AT(b[k], lane);
        // What is out of range is left to exact arithmetic.
        r->s_error = in_range ? AT(s_error, lane) : INFINITY;
        r->slop = AT(key_error, lane) + sqrt(2.0 * r->s_error) * (1.0 + 4.0 * UNIT_ROUNDOFF);
        r->centre[0] = m->centre[lane].x;
        r->centre[1] = m->centre[lane].y;
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < LINEAR; k++)
                o->n[j][k] = scale * (target[j] * AT(n[0][k], lane) + target[3 + j] * AT(n[1][k], lane) +
                                      target[6 + j] * AT(n[2][k], lane));
            o->g[j] = scale * (target[j] * AT(g[0], lane) + target[3 + j] * AT(g[1], lane) + target[6 + j] * AT(g[2], lane));
        }
        // A target frame is a rotation within 1e-6.
        o->key_error = AT(key_error, lane);
        o->n_error = 1.01 * scale * AT(n_error, lane);
        o->g_norm = 1.01 * (sqrt(o->g[0] * o->g[0] + o->g[1] * o->g[1] + o->g[2] * o->g[2]) +
                            scale * AT(map_norm, lane) * 4.0 * AT(m->map_lost, lane) * AT(m->fixed_size, lane));
    }
}
