// Boxes of extent.py as the camera sees them, four at a time.

// Of extent.py.
#define UNBOUNDED 0
#define ELLIPSOID 1
#define BOX 2

// Relative slack for the few roundings of a dot product of three terms and what is derived from it.
#define SLACK 0x1p-44

#define AT(vector, lane) (((__private double *)&(vector))[lane])

typedef struct {
    double4 low, high;
} interval;

static inline double4 dot3(const double4 *a, const double4 *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double4 larger(double4 a, double4 b) { return a > b ? a : b; }

static inline double4 smaller(double4 a, double4 b) { return a < b ? a : b; }

// A box in pixels times depth from the principal point, and in depth: the middle and what leads from it to the middles of
// three faces; rows are u, v, depth (the first two in pixels where rays are parallel).
typedef struct {
    double4 t[3], a[3][3];
    double4 noise[3];       // bounds of the errors of t
} projected;

static projected project(const int *row, __global const double *world_from_object, __global const double *object_centre,
                         __global const double *object_half, __global const double *image_rows,
                         __global const double *origin)
{
    projected p;
    double4 m[12], centre[3], half_size[3];
    for (int lane = 0; lane < 4; lane++) {
        for (int k = 0; k < 12; k++)
            AT(m[k], lane) = world_from_object[12 * row[lane] + k];
        for (int k = 0; k < 3; k++) {
            AT(centre[k], lane) = object_centre[3 * row[lane] + k];
            AT(half_size[k], lane) = object_half[3 * row[lane] + k];
        }
    }
    double4 g[3], magnitude[3];
    for (int r = 0; r < 3; r++) {
        double4 shift = (double4)(0.0), size = (double4)(0.0);
        for (int k = 0; k < 3; k++) {
            shift += m[4 * r + k] * centre[k];
            size += fabs(m[4 * r + k] * centre[k]);
        }
        g[r] = (m[4 * r + 3] - origin[r]) + shift;
        magnitude[r] = fabs(m[4 * r + 3] - origin[r]) + size;
    }
    for (int r = 0; r < 3; r++) {
        p.t[r] = p.noise[r] = (double4)(0.0);
        for (int k = 0; k < 3; k++) {
            p.t[r] += image_rows[3 * r + k] * g[k];
            p.noise[r] += fabs(image_rows[3 * r + k]) * magnitude[k];
            p.a[r][k] = (double4)(0.0);
            for (int j = 0; j < 3; j++)
                p.a[r][k] += image_rows[3 * r + j] * m[4 * j + k];
            p.a[r][k] *= half_size[k];
        }
        p.noise[r] *= SLACK;
    }
    return p;
}

// One of the three rows at one of the eight corners.
static inline double4 at_corner(double4 t, const double4 *a, int corner)
{
    double4 x = (double4)((corner & 1) ? 1.0 : -1.0);
    double4 y = (double4)((corner & 2) ? 1.0 : -1.0);
    double4 z = (double4)((corner & 4) ? 1.0 : -1.0);
    return t + x * a[0] + y * a[1] + z * a[2];
}
