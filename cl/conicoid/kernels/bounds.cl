// Where each quadric can be seen: a pixel box, a range of depths, and whether its record may be the simple one; four
// quadrics per work-item. Everything errs on the side of too large.

#define CULLED 0
#define SIMPLE 1
#define GENERAL 2

static inline double4 reach(const double4 *a, long4 ellipsoid)
{
    double4 sum = fabs(a[0]) + fabs(a[1]) + fabs(a[2]);
    return (ellipsoid & (sum > 0x1p-450) & (sum < 0x1p450)) ? smaller(sqrt(dot3(a, a)), sum) : sum;
}

// Pixel range of an ellipsoid wholly in front of a pinhole, about the middle pixel m: the projected dual conic's
// extent, x = (C13 +- sqrt(C13^2 - C11 C33)) / C33 (Sigg et al. 2006, section 3.2), with the row shifted by m so
// that nothing large cancels.
static inline interval ellipsoid_pixels(double4 t, const double4 *a, double4 per_depth, const double4 *da)
{
    double4 m = t * per_depth;
    // Over the depth, so that no unit of length is too small or too large to square.
    double4 b[3], d[3];
    for (int k = 0; k < 3; k++) {
        b[k] = (a[k] - m * da[k]) * per_depth;
        d[k] = da[k] * per_depth;
    }
    double4 c13 = dot3(b, d);
    double4 c33 = dot3(d, d) - 1.0;
    double4 root = sqrt(larger(c13 * c13 - dot3(b, b) * c33, (double4)(0.0)));
    double4 per_c33 = 1.0 / c33;
    double4 e1 = (c13 + root) * per_c33;
    double4 e2 = (c13 - root) * per_c33;
    double4 slack = 1e-6 * (fabs(e1) + fabs(e2));
    return (interval){m + smaller(e1, e2) - slack, m + larger(e1, e2) + slack};
}

static inline interval box_pixels(double4 t, const double4 *a, double4 depth, const double4 *da)
{
    interval r = {(double4)(INFINITY), (double4)(-INFINITY)};
    for (int corner = 0; corner < 8; corner++) {
        double4 p = at_corner(t, a, corner) / at_corner(depth, da, corner);
        r.low = smaller(r.low, p);
        r.high = larger(r.high, p);
    }
    return r;
}

static inline int clamp_pixel(double x, int low, int high) { return (int)fmin(fmax(x, (double)low), (double)high); }

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void bound_quadrics(int count, __global const double *world_from_object, __global const double *object_centre,
                    __global const double *object_half, __global const uchar *kind, __global const uchar *whole,
                    __global const double *image_rows, __global const double *origin, double2 principal,
                    int orthographic, int4 crop, int2 image, double near, double far, int want_back,
                    __global int4 *box, __global int2 *middle, __global double *nearest, __global uchar *path)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int row[4], boxes = 0;
    long4 ellipsoid, bounded;
    for (int lane = 0; lane < 4; lane++) {
        int i = row[lane] = min(first + lane, count - 1);
        ((__private long *)&ellipsoid)[lane] = kind[i] == ELLIPSOID ? -1 : 0;
        ((__private long *)&bounded)[lane] = kind[i] != UNBOUNDED ? -1 : 0;
        boxes |= kind[i] == BOX;
    }
    projected p = project(row, world_from_object, object_centre, object_half, image_rows, origin);
    const double4 *t = p.t, *noise = p.noise, (*a)[3] = p.a;
    double4 depth_reach = reach(a[2], ellipsoid);
    depth_reach += SLACK * depth_reach + noise[2];
    double4 low = t[2] - depth_reach;
    double4 high = t[2] + depth_reach;
    bounded &= (low > -INFINITY) & (high < INFINITY);
    long4 in_front = bounded & (low > 0.0);

    interval h, w;
    double4 blur = (double4)(1.0);
    if (orthographic) {
        // A millionth as in ellipsoid_pixels: set-up counts on it.
        double4 rx = reach(a[0], ellipsoid) * (1.0 + 1e-6), ry = reach(a[1], ellipsoid) * (1.0 + 1e-6);
        h = (interval){t[0] - rx, t[0] + rx};
        w = (interval){t[1] - ry, t[1] + ry};
    } else {
        double4 per_depth = 1.0 / t[2];
        h = ellipsoid_pixels(t[0], a[0], per_depth, a[2]);
        w = ellipsoid_pixels(t[1], a[1], per_depth, a[2]);
        if (boxes) {
            interval bh = box_pixels(t[0], a[0], t[2], a[2]), bw = box_pixels(t[1], a[1], t[2], a[2]);
            h = (interval){ellipsoid ? h.low : bh.low, ellipsoid ? h.high : bh.high};
            w = (interval){ellipsoid ? w.low : bw.low, ellipsoid ? w.high : bw.high};
        }
        blur = 1.0 / low;
    }
    // The pixel noise of the projected centre, and of the depth it was divided by.
    double4 bu = blur * (noise[0] + SLACK * depth_reach + noise[2] * larger(fabs(h.low), fabs(h.high)));
    double4 bv = blur * (noise[1] + SLACK * depth_reach + noise[2] * larger(fabs(w.low), fabs(w.high)));
    long4 seen = bounded & (orthographic ? (long4)(-1) : in_front);
    double4 u = seen ? 0.5 * (h.low + h.high) + principal.x : (double4)(0.5 * image.x);
    double4 v = seen ? 0.5 * (w.low + w.high) + principal.y : (double4)(0.5 * image.y);
    double4 edge[4] = {h.low + principal.x - bu - 1e-9 * fabs(u), w.low + principal.y - bv - 1e-9 * fabs(v),
                       h.high + principal.x + bu + 1e-9 * fabs(u), w.high + principal.y + bv + 1e-9 * fabs(v)};
    for (int k = 0; k < 4; k++) {
        // Pixel i is sampled at i + 0.5; a NaN leaves the whole crop.
        edge[k] = k < 2 ? ceil(edge[k] - 0.5) : floor(edge[k] - 0.5) + 1.0;
        double whole_crop = k == 0 ? crop.x : k == 1 ? crop.y : k == 2 ? crop.z : crop.w;
        edge[k] = (seen & (edge[k] == edge[k])) ? edge[k] : (double4)(whole_crop);
    }
    for (int lane = 0; lane < 4 && first + lane < count; lane++) {
        int i = first + lane;
        int4 b = (int4)(clamp_pixel(AT(edge[0], lane), crop.x, crop.z), clamp_pixel(AT(edge[1], lane), crop.y, crop.w),
                        clamp_pixel(AT(edge[2], lane), crop.x, crop.z), clamp_pixel(AT(edge[3], lane), crop.y, crop.w));
        double nearer = AT(low, lane), farther = AT(high, lane);
        int known = ((__private long *)&bounded)[lane] != 0, front = ((__private long *)&in_front)[lane] != 0;
        int unseen = b.x >= b.z || b.y >= b.w || (known && (farther < near || nearer > far || farther <= 0.0));
        int simple = whole[i] && front && nearer > near && farther < far && !want_back;
        // Orthographic keys b + sqrt(S) lose what t gains by being near: only far enough from the camera's plane.
        if (orthographic && nearer < 0.25 * farther)
            simple = 0;
        box[i] = b;
        middle[i] = (int2)(clamp_pixel(rint(AT(u, lane)), 0, image.x), clamp_pixel(rint(AT(v, lane)), 0, image.y));
        nearest[i] = known ? fmax(nearer, 0.0) : 0.0;
        path[i] = unseen ? CULLED : simple ? SIMPLE : GENERAL;
    }
}
