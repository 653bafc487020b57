// The polynomials of a record and their error bounds at single pixels, by the functions that casting calls.

#define ROW 16

static inline void middle_of(int2 pixel, int2 *tile, reals *x, real *y)
{
    *tile = (int2)(pixel.x / TILE * TILE, pixel.y / TILE * TILE) + TILE / 2;
    *x = (reals)((real)(pixel.x - tile->x) + (real)0.5);
    *y = (real)(pixel.y - tile->y) + (real)0.5;
}

__kernel void evaluate_general(__global const int2 *pixel, __global const int *row, __global const general_record *general,
                               __global const clip_record *clips, __global double *out)
{
    int i = get_global_id(0);
    int2 tile;
    reals x;
    real y;
    middle_of(pixel[i], &tile, &x, &y);
    general_tile g = move_general(general + row[i], clips, tile.x, tile.y, 0, INFINITY);
    reals value[8] = {at_quadratic(g.s, x, y), at_quadratic(g.a, x, y), at_linear(g.b, x, y), at_quadratic(g.c, x, y)};
    double error[8] = {g.s.error, g.a.error, g.b.error, g.c.error};
    if (g.flags & HAS_RANGE)
        for (int side = 0; side < 2; side++) {
            value[4 + 2 * side] = at_linear(g.range[side], x, y);
            error[4 + 2 * side] = g.range[side].error;
            value[5 + 2 * side] = at_quadratic(g.cap[side], x, y);
            error[5 + 2 * side] = g.cap[side].error;
        }
    for (int k = 0; k < 8; k++) {
        out[ROW * i + 2 * k] = LANE(real, value[k], 0);
        out[ROW * i + 2 * k + 1] = error[k];
    }
}

// Then the key and the gradient, where the root is clear of its error, with infinite bounds elsewhere.
__kernel void evaluate_simple(__global const int2 *pixel, __global const int *row, __global const slot_record *slots,
                              __global const frame *f, __global double *out)
{
    int i = get_global_id(0);
    int2 tile;
    reals x;
    real y;
    middle_of(pixel[i], &tile, &x, &y);
    __global const slot_record *r = slots + row[i];
    double du = tile.x - r->centre[0], dv = tile.y - r->centre[1];
    quadratic form = local_quadratic(r->s, du, dv);
    reals s = at_quadratic(form, x + LOCAL(du), y + LOCAL(dv));
    form.one += r->s_error;
    reals root = sqrt(at_quadratic(form, x + LOCAL(du), y + LOCAL(dv))), root_error = simple_root_error(r, root);
    reals b = at_linear(local_linear(r->b, du, dv), x + LOCAL(du), y + LOCAL(dv));
    out[ROW * i] = LANE(real, s, 0);
    out[ROW * i + 1] = r->s_error;
    out[ROW * i + 2] = LANE(real, b, 0);
    out[ROW * i + 3] = r->key_error;
    mask unclear = unclear_root(r, root);
    vector3 n = simple_gradient_at(f, r, root, root_error, x + LOCAL(du), y + LOCAL(dv));
    out[ROW * i + 4] = LANE(real, b, 0) + LANE(real, root, 0);
    out[ROW * i + 5] = LANE(integer, unclear, 0) ? INFINITY : r->key_error + LANE(real, root_error, 0);
    out[ROW * i + 6] = LANE(real, n.x, 0);
    out[ROW * i + 7] = LANE(real, n.y, 0);
    out[ROW * i + 8] = LANE(real, n.z, 0);
    out[ROW * i + 9] = LANE(integer, unclear, 0) ? INFINITY : LANE(real, n.error, 0);
}
