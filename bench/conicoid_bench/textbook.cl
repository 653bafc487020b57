/* A ray tracer of quadrics as it is usually written: a, b and c per ray in the quadric's own space, then the quadratic
 * formula in the form that does not cancel (q = -(b + sign(b) sqrt(b^2 - ac)), t = q/a and c/q).
 *
 * REAL: float or double. KAHAN: b^2 - ac by two fma, within 1.5 ulp of the discriminant of the rounded a, b and c.
 */

#ifndef REAL
#error "REAL is float or double"
#endif
#define TILE 16

typedef struct {
    REAL rows[12];  /* parameter space from world, 3 x 4 */
    REAL form[5];   /* of X^2, Y^2, Z^2, of Z, and the constant */
    REAL range[2];
    REAL capped;
} Quadric;

REAL discriminant(REAL a, REAL b, REAL c)
{
#ifdef KAHAN
    REAL product = a * c;
    REAL error = fma(-a, c, product);
    return fma(b, b, -product) + error;
#else
    return b * b - a * c;
#endif
}

REAL transformed(__global const REAL *row, REAL x, REAL y, REAL z, REAL w)
{
    return row[0] * x + row[1] * y + row[2] * z + row[3] * w;
}

__kernel void trace(int width, int height, __constant REAL *rays, __global const int *tile_end,
                    __global const int *entries, __global const Quadric *quadrics, __global const uint *ids,
                    __global float *depths, __global uint *seen, __global float *normals)
{
    int x = get_global_id(0), y = get_global_id(1);
    int tile = get_group_id(1) * get_num_groups(0) + get_group_id(0);
    if (x >= width || y >= height)
        return;
    REAL u = x + (REAL)0.5, v = y + (REAL)0.5;
    REAL ox = rays[0] * u + rays[1] * v + rays[2];
    REAL oy = rays[3] * u + rays[4] * v + rays[5];
    REAL oz = rays[6] * u + rays[7] * v + rays[8];
    REAL dx = rays[9] * u + rays[10] * v + rays[11];
    REAL dy = rays[12] * u + rays[13] * v + rays[14];
    REAL dz = rays[15] * u + rays[16] * v + rays[17];

    REAL nearest = INFINITY, nx = 0, ny = 0, nz = 0;
    uint id = 0;
    for (int k = tile ? tile_end[tile - 1] : 0; k < tile_end[tile]; k++) {
        __global const Quadric *quadric = quadrics + entries[k];
        __global const REAL *rows = quadric->rows, *form = quadric->form;
        REAL px = transformed(rows, ox, oy, oz, 1), ex = transformed(rows, dx, dy, dz, 0);
        REAL py = transformed(rows + 4, ox, oy, oz, 1), ey = transformed(rows + 4, dx, dy, dz, 0);
        REAL pz = transformed(rows + 8, ox, oy, oz, 1), ez = transformed(rows + 8, dx, dy, dz, 0);
        REAL a = form[0] * ex * ex + form[1] * ey * ey + form[2] * ez * ez;
        REAL b = form[0] * px * ex + form[1] * py * ey + form[2] * pz * ez + form[3] * ez / 2;
        REAL c = form[0] * px * px + form[1] * py * py + form[2] * pz * pz + form[3] * pz + form[4];

        REAL hit = nearest, gx = 0, gy = 0, gz = 0;
        REAL square = discriminant(a, b, c);
        if (square >= 0) {
            REAL q = -(b + copysign(sqrt(square), b));
            REAL roots[2] = {q / a, c / q};
            for (int i = 0; i < 2; i++) {
                REAL height_there = pz + roots[i] * ez;
                if (roots[i] > 0 && roots[i] < hit && height_there >= quadric->range[0] &&
                    height_there <= quadric->range[1]) {
                    hit = roots[i];
                    gx = form[0] * (px + hit * ex);
                    gy = form[1] * (py + hit * ey);
                    gz = form[2] * height_there + form[3] / 2;
                }
            }
        }
        for (int i = 0; i < 2 && quadric->capped; i++) {
            REAL t = (quadric->range[i] - pz) / ez;
            if (t > 0 && t < hit && (a * t + 2 * b) * t + c <= 0) {
                hit = t;
                gx = gy = 0;
                gz = 1;  /* turned to face below */
            }
        }
        if (hit < nearest) {
            nearest = hit;
            id = ids[entries[k]];
            nx = rows[0] * gx + rows[4] * gy + rows[8] * gz;
            ny = rows[1] * gx + rows[5] * gy + rows[9] * gz;
            nz = rows[2] * gx + rows[6] * gy + rows[10] * gz;
        }
    }
    REAL length = sqrt(nx * nx + ny * ny + nz * nz);
    REAL turn = nx * dx + ny * dy + nz * dz > 0 ? -1 : 1;
    REAL scale = length > 0 ? turn / length : 0;
    int pixel = y * width + x;
    depths[pixel] = nearest;
    seen[pixel] = id;
    normals[3 * pixel] = nx * scale;
    normals[3 * pixel + 1] = ny * scale;
    normals[3 * pixel + 2] = nz * scale;
}
