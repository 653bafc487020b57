// From an ellipsoid's moments along the rays to its record: what both ways of setting it up share.
//
// D = diag(1, 1, 1, -1), so S = |V4 F - F4 V|^2 - |F x V|^2 with no cancellation but the silhouette's own: once the
// moments are known, binary64 loses nothing that casting would keep.

#define IS(mask, lane) (((__private const long *)&(mask))[lane] != 0)

// Four quadrics' rays in parameter space, to binary64, and bounds of what was lost before.
typedef struct {
    int2 centre[4];
    double4 fixed[4], moving[LINEAR][4];
    double4 l[6][LINEAR];       // L12 L13 L23 L14 L24 L34, Lij = Fi Vj - Fj Vi
    double4 ff, fv[LINEAR];     // F'DF, F'DV
    // Lost: lengths of the errors of all moments' coefficients, errors of those of F'DV, and of F'DF.
    double4 l_lost[LINEAR], fv_lost[LINEAR], ff_lost;
    long4 in_range;
} moments;

// The frame as records are bounded in it.
typedef struct {
    int4 crop;
    int orthographic;
    double2 principal;
    double axis[3];             // lengths of the gradients of u, v (times depth, about the principal point) and depth
} bounds_frame;

// The farthest pixel of each box from its centre, (|u|, |v|, 1), a margin farther.
static void reach_of(const int *quadric, const int2 *centre, __global const int4 *box, double4 margin, double4 *reach)
{
    for (int lane = 0; lane < 4; lane++) {
        int4 b = box[quadric[lane]];
        AT(reach[0], lane) = max(abs(b.x - centre[lane].x), abs(b.z - centre[lane].x));
        AT(reach[1], lane) = max(abs(b.y - centre[lane].y), abs(b.w - centre[lane].y));
    }
    reach[0] += margin;
    reach[1] += margin;
    reach[2] = (double4)(1.0);
}

// Lanes whose boxes are small and inside the crop, so that they hold the whole ellipse.
static long4 whole_ellipses(const int *quadric, __global const int4 *box, int4 crop)
{
    long4 whole;
    for (int lane = 0; lane < 4; lane++) {
        int4 b = box[quadric[lane]];
        ((__private long *)&whole)[lane] = b.x > crop.x && b.y > crop.y && b.z < crop.z && b.w < crop.w &&
                                           max(b.z - b.x, b.w - b.y) < 4 * TILE ? -1 : 0;
    }
    return whole;
}

// Sums of the magnitudes of the terms of S, expanded in the moments, are at most the square of this times F'DF.
static double4 moment_norm(const moments *m, const double4 *reach)
{
    double4 norm = (double4)(0.0);
    for (int p = 0; p < 6; p++) {
        double4 moment = reach[0] * fabs(m->l[p][0]) + reach[1] * fabs(m->l[p][1]) + fabs(m->l[p][2]);
        norm += moment * moment;
    }
    return sqrt(norm);
}

// The error of S at `reach`. Roundings that a term passes through at most: 14 in set-up (moments, sums, products by a
// rounded 1/F'DF), 5 in evaluation, 1 in raising S.
static double4 error_of_s(const moments *m, const double4 *reach, double4 l_norm, double4 per_size, double4 skew)
{
    double4 lost = (reach[0] * m->l_lost[0] + reach[1] * m->l_lost[1] + m->l_lost[2]) * per_size;
    return (22.0 * UNIT_ROUNDOFF + 2.5 * skew) * l_norm * l_norm + (2.0 * l_norm + lost) * lost;
}

// Rounded up; what underflows is replaced by something larger.
static inline float bound(double x) { return (float)x * 1.000001f + 0x1p-120f; }

// Writes up to `lanes` records; open[lane] tells which of them deserve double-double.
static void write_simple(const moments *m, const int *quadric, __global const int *slot_of, int lanes,
                         const bounds_frame *frame, __global const int4 *box, __global const float *nearest,
                         __global slot_record *slots, int *open)
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
    // Pinhole: key = -b/c + sqrt(S)/|c|. Orthographic: key = -t = b/a + sqrt(S)/a.
    double4 b[LINEAR], per_ff = 1.0 / m->ff;
    double4 side = frame->orthographic ? per_ff : -per_ff;
    for (int k = 0; k < LINEAR; k++)
        b[k] = m->fv[k] * side;
    for (int k = 0; k < QUADRATIC; k++)
        s[k] = (s[k] * per_ff) * per_ff;

    // The conic's highest value, where it is an ellipse.
    double4 bend = 4.0 * s[0] * s[2] - s[1] * s[1];
    double4 summit = s[5] + (s[1] * s[3] * s[4] - s[2] * s[3] * s[3] - s[0] * s[4] * s[4]) / bend;
    // Casting looks at whole tiles. Beyond the box of a whole, small ellipse, though, S falls faster than its error grows:
    // at rho times the way from its middle to its rim S is summit (1 - rho^2), the error at most (2 rho - 1)^2 times that of
    // the box, and boxes leave a millionth to the rim.
    double4 per_size = fabs(per_ff), skew = m->ff_lost * per_size, reach[LINEAR];
    reach_of(quadric, m->centre, box, (double4)(0.0), reach);
    double4 l_norm = moment_norm(m, reach) * per_size, s_error = error_of_s(m, reach, l_norm, per_size, skew);
    long4 ellipse = bend > 0x1p-18 * fabs(s[0] * s[2]);
    long4 alone = whole_ellipses(quadric, box, frame->crop) & ellipse & (summit > 0x1p22 * s_error);
    reach_of(quadric, m->centre, box, alone ? (double4)(0.0) : (double4)(TILE), reach);
    l_norm = moment_norm(m, reach) * per_size;
    s_error = error_of_s(m, reach, l_norm, per_size, skew);

    double4 f_norm = (double4)(0.0), b_norm[LINEAR], b_lost[LINEAR], b_size = f_norm, b_error = f_norm;
    for (int i = 0; i < 4; i++)
        f_norm += m->fixed[i] * m->fixed[i];
    f_norm = sqrt(f_norm) * per_size;
    for (int k = 0; k < LINEAR; k++) {
        double4 length = (double4)(0.0);
        for (int i = 0; i < 4; i++)
            length += m->moving[k][i] * m->moving[k][i];
        b_norm[k] = f_norm * sqrt(length);
        b_lost[k] = m->fv_lost[k] * per_size + 1.25 * skew * b_norm[k];
        b_size += reach[k] * b_norm[k];
        b_error += reach[k] * b_lost[k];
    }
    // b: 4 roundings in set-up and 3 in evaluation; sqrt(S): 1; the key, its bar and the comparison with another: 4.
    double4 key_error = UNIT_ROUNDOFF * (12.0 * b_size + 6.0 * l_norm) + b_error;
    // The gradient, sum_k axis_k (sqrt(S) b_k + S_k / 2) with the conic's partial derivatives S_k: those are sums of products
    // of moments with one coefficient left out, within s_error / reach_k, and 12 more roundings are in products and sums;
    // an axis in camera space is a product of two matrices, which counts as 7 (4, times the norm of a rotation's magnitudes).
    double4 n_error = (double4)(0.0), root_norm = (double4)(0.0);
    for (int k = 0; k < LINEAR; k++) {
        double4 axis = (double4)(frame->axis[k]);
        for (int lane = 0; lane < 4 && k < 2 && !frame->orthographic; lane++)
            AT(axis, lane) += frame->axis[2] * fabs(k == 0 ? frame->principal.x - m->centre[lane].x
                                                           : frame->principal.y - m->centre[lane].y);
        double4 of_root = fabs(b[k]) + b_lost[k];
        double4 rounded = 24.0 * UNIT_ROUNDOFF * b_norm[k] + b_lost[k];
        if (frame->orthographic && k == 2) {
            // The third is sqrt(S) alone.
            of_root = (double4)(1.0);
            rounded = (double4)(12.0 * UNIT_ROUNDOFF);
        }
        n_error += axis * ((s_error + 12.0 * UNIT_ROUNDOFF * l_norm * l_norm) / reach[k] + l_norm * rounded);
        root_norm += axis * of_root;
    }

    long4 usable = m->in_range;
    for (int k = 0; k < QUADRATIC; k++)
        usable &= all_workable(s[k]) & all_workable(b[k % LINEAR]);
    for (int p = 0; p < 6; p++)
        for (int k = 0; k < LINEAR; k++)
            usable &= all_workable(m->l[p][k]);
    // An eye so near the surface that F'DF itself is in doubt.
    usable &= skew < 0x1p-20;
    long4 sharp = ellipse & (summit > 0x1p32 * s_error);
    for (int lane = 0; lane < lanes; lane++) {
        int slot = slot_of[quadric[lane]];
        int4 own_box = box[quadric[lane]];
        slot_record own __attribute__((aligned(32)));
        slot_record *r = &own;
        int in_range = IS(usable, lane);
        // Many pixels deserve close bounds: each that they leave open costs as much as one quadric in double-double.
        open[lane] = !in_range || !IS(sharp, lane) || (own_box.z - own_box.x) * (own_box.w - own_box.y) > 1024;
        for (int k = 0; k < QUADRATIC; k++)
            r->s[k] = AT(s[k], lane);
        for (int k = 0; k < LINEAR; k++)
            r->b[k] = AT(b[k], lane);
        // What is out of range is left to exact arithmetic.
        r->s_error = in_range ? bound(AT(s_error, lane)) : INFINITY;
        r->slop = bound(AT(key_error, lane) + sqrt(2.0 * r->s_error));
        r->key_error = bound(AT(key_error, lane));
        r->n_error = bound(AT(n_error, lane));
        r->root_norm = bound(AT(root_norm, lane));
        r->nearest = nearest[slot];
        r->centre[0] = m->centre[lane].x;
        r->centre[1] = m->centre[lane].y;
        r->box[0] = own_box.x;
        r->box[1] = own_box.y;
        r->box[2] = own_box.z;
        r->box[3] = own_box.w;
        r->general = -1;
        r->quadric = quadric[lane];
        // Slots lie anywhere: streamed past the cache, which saves reading them first.
        for (int k = 0; k < 4; k++)
            __builtin_nontemporal_store(((double4 *)r)[k], (__global double4 *)(slots + slot) + k);
    }
}
