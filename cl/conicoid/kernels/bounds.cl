// Where each quadric can be seen: a pixel box, a range of depths, and whether its record may be the simple one.
// Everything errs on the side of too large.

#define CULLED 0
#define SIMPLE 1
#define GENERAL 2

#define UNBOUNDED 0
#define ELLIPSOID 1

// Relative slack for the few roundings of a dot product of three terms and what is derived from it.
#define SLACK 0x1p-44

typedef struct {
    double low, high;
} interval;

static inline double dot3(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double reach(const double *a, int ellipsoid)
{
    double sum = fabs(a[0]) + fabs(a[1]) + fabs(a[2]);
    if (!ellipsoid || !(sum > 0x1p-450 && sum < 0x1p450))
        return sum;
    return fmin(sqrt(dot3(a, a)), sum);
}

// Pixel range of an ellipsoid wholly in front of a pinhole, about the middle pixel m: the projected dual conic's
// extent, x = (C13 +- sqrt(C13^2 - C11 C33)) / C33 (Sigg et al. 2006, section 3.2), with the row shifted by m so
// that nothing large cancels.
static inline interval ellipsoid_pixels(double t, const double *a, double depth, const double *da)
{
    double m = t / depth;
    // Over the depth, so that no unit of length is too small or too large to square.
    double b[3], d[3];
    for (int k = 0; k < 3; k++) {
        b[k] = (a[k] - m * da[k]) / depth;
        d[k] = da[k] / depth;
    }
    double c13 = dot3(b, d);
    double c33 = dot3(d, d) - 1.0;
    double root = sqrt(fmax(c13 * c13 - dot3(b, b) * c33, 0.0));
    double e1 = (c13 + root) / c33;
    double e2 = (c13 - root) / c33;
    double slack = 1e-6 * (fabs(e1) + fabs(e2));
    return (interval){m + fmin(e1, e2) - slack, m + fmax(e1, e2) + slack};
}

static inline interval box_pixels(double t, const double *a, double depth, const double *da)
{
    interval r = {INFINITY, -INFINITY};
    for (int corner = 0; corner < 8; corner++) {
        double x = (corner & 1) ? 1.0 : -1.0;
        double y = (corner & 2) ? 1.0 : -1.0;
        double z = (corner & 4) ? 1.0 : -1.0;
        double p = (t + x * a[0] + y * a[1] + z * a[2]) / (depth + x * da[0] + y * da[1] + z * da[2]);
        r.low = fmin(r.low, p);
        r.high = fmax(r.high, p);
    }
    return r;
}

static inline int clamp_pixel(double x, int low, int high) { return (int)fmin(fmax(x, (double)low), (double)high); }

__kernel void bound_quadrics(int count, __global const double *world_from_object, __global const double *centre,
                             __global const double *half_size, __global const uchar *kind, __global const uchar *whole,
                             __global const double *image_rows, __global const double *origin, double2 principal,
                             int orthographic, int4 crop, int2 image, double near, double far, int want_back,
                             __global int4 *box, __global int2 *middle, __global double *nearest, __global uchar *path)
{
    int i = get_global_id(0) + get_global_size(0) * get_global_id(1);
    if (i >= count)
        return;
    double m[12];
    for (int k = 0; k < 12; k++)
        m[k] = world_from_object[12 * i + k];
    double g[3], magnitude[3];
    for (int r = 0; r < 3; r++) {
        double shift = 0.0, size = 0.0;
        for (int k = 0; k < 3; k++) {
            shift += m[4 * r + k] * centre[3 * i + k];
            size += fabs(m[4 * r + k] * centre[3 * i + k]);
        }
        g[r] = (m[4 * r + 3] - origin[r]) + shift;
        magnitude[r] = fabs(m[4 * r + 3] - origin[r]) + size;
    }
    double t[3], a[3][3], noise[3];
    for (int r = 0; r < 3; r++) {
        t[r] = noise[r] = 0.0;
        for (int k = 0; k < 3; k++) {
            t[r] += image_rows[3 * r + k] * g[k];
            noise[r] += fabs(image_rows[3 * r + k]) * magnitude[k];
            a[r][k] = 0.0;
            for (int j = 0; j < 3; j++)
                a[r][k] += image_rows[3 * r + j] * m[4 * j + k];
            a[r][k] *= half_size[3 * i + k];
        }
        noise[r] *= SLACK;
    }
    int ellipsoid = kind[i] == ELLIPSOID;
    double depth_reach = reach(a[2], ellipsoid);
    depth_reach += SLACK * depth_reach + noise[2];
    double low = t[2] - depth_reach;
    double high = t[2] + depth_reach;
    int bounded = kind[i] != UNBOUNDED && isfinite(high) && isfinite(low);
    int in_front = bounded && low > 0.0;

    double u0 = crop.x, u1 = crop.z, v0 = crop.y, v1 = crop.w;
    double u = 0.5 * image.x, v = 0.5 * image.y;
    if (bounded && (in_front || orthographic)) {
        interval h, w;
        double blur = 1.0;
        if (orthographic) {
            // A millionth as in ellipsoid_pixels: set-up counts on it.
            double rx = reach(a[0], ellipsoid) * (1.0 + 1e-6), ry = reach(a[1], ellipsoid) * (1.0 + 1e-6);
            h = (interval){t[0] - rx, t[0] + rx};
            w = (interval){t[1] - ry, t[1] + ry};
        } else {
            h = ellipsoid ? ellipsoid_pixels(t[0], a[0], t[2], a[2]) : box_pixels(t[0], a[0], t[2], a[2]);
            w = ellipsoid ? ellipsoid_pixels(t[1], a[1], t[2], a[2]) : box_pixels(t[1], a[1], t[2], a[2]);
            blur = 1.0 / low;
        }
        // The pixel noise of the projected centre, and of the depth it was divided by.
        double bu = blur * (noise[0] + SLACK * depth_reach + noise[2] * fmax(fabs(h.low), fabs(h.high)));
        double bv = blur * (noise[1] + SLACK * depth_reach + noise[2] * fmax(fabs(w.low), fabs(w.high)));
        u = 0.5 * (h.low + h.high) + principal.x;
        v = 0.5 * (w.low + w.high) + principal.y;
        u0 = h.low + principal.x - bu - 1e-9 * fabs(u);
        u1 = h.high + principal.x + bu + 1e-9 * fabs(u);
        v0 = w.low + principal.y - bv - 1e-9 * fabs(v);
        v1 = w.high + principal.y + bv + 1e-9 * fabs(v);
        // Pixel i is sampled at i + 0.5; a NaN leaves the whole crop.
        u0 = u0 == u0 ? ceil(u0 - 0.5) : crop.x;
        v0 = v0 == v0 ? ceil(v0 - 0.5) : crop.y;
        u1 = u1 == u1 ? floor(u1 - 0.5) + 1.0 : crop.z;
        v1 = v1 == v1 ? floor(v1 - 0.5) + 1.0 : crop.w;
    }
    int4 b = (int4)(clamp_pixel(u0, crop.x, crop.z), clamp_pixel(v0, crop.y, crop.w), clamp_pixel(u1, crop.x, crop.z),
                    clamp_pixel(v1, crop.y, crop.w));
    int unseen = b.x >= b.z || b.y >= b.w || (bounded && (high < near || low > far || high <= 0.0));
    int simple = whole[i] && in_front && low > near && high < far && !want_back;
    // Orthographic keys b + sqrt(S) lose what t gains by being near: only far enough from the camera's plane.
    if (orthographic && low < 0.25 * high)
        simple = 0;
    box[i] = b;
    middle[i] = (int2)(clamp_pixel(rint(u), 0, image.x), clamp_pixel(rint(v), 0, image.y));
    nearest[i] = bounded ? fmax(low, 0.0) : 0.0;
    path[i] = unseen ? CULLED : simple ? SIMPLE : GENERAL;
}
