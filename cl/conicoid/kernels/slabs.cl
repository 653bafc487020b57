// Closer bounds on the image than pixel boxes, of general records: strips along the projections of their boxes' three axes.
// For parallel rays they meet in the very outline of the box; a box that reaches behind the eye has none.

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void bound_closely(int count, __global const int *list, __global const double *world_from_object,
                   __global const double *object_centre, __global const double *object_half, __global const uchar *kind,
                   __global const double *image_rows, __global const double *origin, double2 principal,
                   int orthographic, __global general_record *records)
{
    int first = 4 * (get_global_id(0) + get_global_size(0) * get_global_id(1));
    if (first >= count)
        return;
    int row[4];
    for (int lane = 0; lane < 4; lane++)
        row[lane] = list[min(first + lane, count - 1)];
    projected p = project(row, world_from_object, object_centre, object_half, image_rows, origin);
    double4 deep = fabs(p.a[2][0]) + fabs(p.a[2][1]) + fabs(p.a[2][2]);
    deep += SLACK * deep + p.noise[2];
    double4 nearest = p.t[2] - deep;
    double4 u[8], v[8], far_out = (double4)(0.0);
    for (int corner = 0; corner < 8; corner++) {
        double4 per_depth = orthographic ? (double4)(1.0) : 1.0 / at_corner(p.t[2], p.a[2], corner);
        u[corner] = at_corner(p.t[0], p.a[0], corner) * per_depth;
        v[corner] = at_corner(p.t[1], p.a[1], corner) * per_depth;
        // A sum, so that a NaN stays.
        far_out += fabs(u[corner]) + fabs(v[corner]);
    }
    // As in bounds.cl, both directions together; a billionth of all that is added and subtracted is far beyond rounding.
    double4 blur = orthographic ? (double4)(1.0) : 1.0 / nearest;
    double4 noise = blur * (p.noise[0] + p.noise[1] + 2.0 * SLACK * deep + p.noise[2] * far_out);
    double4 slack = noise + 1e-9 * (far_out + fabs(principal.x) + fabs(principal.y));
    double4 middle_u = orthographic ? (double4)(0.0) : p.t[0] / p.t[2];
    double4 middle_v = orthographic ? (double4)(0.0) : p.t[1] / p.t[2];
    for (int axis = 0; axis < 3; axis++) {
        // Any direction is right; these are the ones in which the box is narrow.
        double4 across = p.a[1][axis] - middle_v * p.a[2][axis], up = middle_u * p.a[2][axis] - p.a[0][axis];
        double4 length = sqrt(across * across + up * up);
        across /= length;
        up /= length;
        double4 low = (double4)(INFINITY), high = (double4)(-INFINITY);
        for (int corner = 0; corner < 8; corner++) {
            double4 at = across * u[corner] + up * v[corner];
            low = smaller(low, at);
            high = larger(high, at);
        }
        low -= slack + 1e-6 * (high - low);
        high += slack + 1e-6 * (high - low);
        for (int lane = 0; lane < 4 && first + lane < count; lane++) {
            __global general_record *r = records + first + lane;
            double shift = AT(across, lane) * (principal.x - r->centre[0]) + AT(up, lane) * (principal.y - r->centre[1]);
            double ends[2] = {AT(low, lane) + shift, AT(high, lane) + shift};
            int known = kind[row[lane]] != UNBOUNDED && (orthographic || AT(nearest, lane) > 0.0) &&
                        ends[1] - ends[0] < INFINITY;
            r->slab[axis][0] = known ? AT(across, lane) : 0.0;
            r->slab[axis][1] = known ? AT(up, lane) : 0.0;
            r->slab[axis][2] = known ? ends[0] : 0.0;
            r->slab[axis][3] = known ? ends[1] : 0.0;
        }
    }
}
