// What needs the winner's own form: its normal, and a closer bound of its key's error than casting needed.

// Fused whatever the precision.
#pragma OPENCL FP_CONTRACT ON

// 1/sqrt(square), its relative error below 2^-50: a binary32 start and one step of the third order, which cost half of
// sqrt and divide. Only for squares well inside binary32's range.
static inline reals inverse_length(reals square)
{
#if REAL_BITS == 64
    if (!some((square < 0x1p-100) | (square > 0x1p100))) {
        reals r = FROM_FLOATS(1 / sqrt(TO_FLOATS(square)));
        // (1 - h)^-1/2 = 1 + h/2 + 3h^2/8 + ...; |h| < 2^-20.
        reals h = 1 - square * r * r;
        return r + r * h * (0.375 * h + 0.5);
    }
#endif
    return 1 / sqrt(square);
}

static inline vector3 choose(mask mine, vector3 a, vector3 b)
{
    a.x = mine ? a.x : b.x;
    a.y = mine ? a.y : b.y;
    a.z = mine ? a.z : b.z;
#if EXACT
    a.error = mine ? a.error : b.error;
#endif
    return a;
}

// Back along the ray of absolute pixel coordinates: for gradients that vanish.
static vector3 towards_eye(__global const frame *f, reals u, real v, vector3 gradient)
{
    vector3 n;
    n.x = (real)f->back[0][0] * u + ((real)f->back[0][1] * v + (real)f->back[0][2]);
    n.y = (real)f->back[1][0] * u + ((real)f->back[1][1] * v + (real)f->back[1][2]);
    n.z = (real)f->back[2][0] * u + ((real)f->back[2][1] * v + (real)f->back[2][2]);
#if EXACT
    // One that only seems to vanish has an error.
    n.error = gradient.error;
    for (int j = 0; j < 3; j++)
        n.error += 4 * UNIT_ROUNDOFF * (magnitude(f->back[j][0] * u) + fabs(f->back[j][1] * v) + fabs(f->back[j][2]));
#endif
    return n;
}

// General winners, one by one, so that each form is moved to the tile once: their gradients, and errors of their keys.
static void general_gradients(__global const frame *f, tile_state *tile, const lists *in, vector3 *gradient)
{
    int middle_u = in->u0 + TILE / 2, middle_v = in->v0 + TILE / 2;
    mask left[CELLS];
    for (int cell = 0; cell < CELLS; cell++)
        left[cell] = tile->winner[cell] >> 2;
    for (int start = 0; start < CELLS;) {
        integer slot = MISS;
        for (int lane = 0; lane < LANES; lane++)
            slot = LANE(integer, left[start], lane) != MISS ? LANE(integer, left[start], lane) : slot;
        if (slot == MISS) {
            start++;
            continue;
        }
        int general = in->slots[slot].general;
        general_tile g;
        general_normal gn;
        if (general >= 0) {
            __global const general_record *r = in->general + general;
            g = move_general(r, in->clips, middle_u, middle_v, in->near, in->far);
            gn = move_general_normal(r, middle_u - r->centre[0], middle_v - r->centre[1]);
        }
        int last = min(in->slots[slot].box[3] - in->v0, TILE) * VECTORS;
        for (int cell = start; cell < last; cell++) {
            mask mine = left[cell] == (mask)(slot);
            if (!some(mine))
                continue;
            left[cell] = mine ? (mask)(MISS) : left[cell];
            if (general < 0)
                continue;
#if EXACT
            tile->error[cell] = mine ? tile->key[cell] - tile->bar[cell] : tile->error[cell];
#endif
            if (!(f->channels & WANT_N))
                continue;
            reals x = in->ramp + (real)(cell % VECTORS * LANES);
            real y = cell / VECTORS + (real)0.5 - TILE / 2;
            vector3 n = general_normal_at(&g, &gn, tile->winner[cell] & 3, f->outward, x, y);
            mask vanishes = mine & ~(magnitude(n.x) + magnitude(n.y) + magnitude(n.z) > 0);
            if (some(vanishes))
                n = choose(vanishes, towards_eye(f, x + (real)middle_u, y + (real)middle_v, n), n);
            gradient[cell] = choose(mine, n, gradient[cell]);
        }
    }
}

// The simple winners of one cell: blends their gradients into `n`.
static inline vector3 simple_gradients(__global const frame *f, tile_state *tile, const lists *in, int cell, reals u,
                                       real v, vector3 n)
{
    mask slots = tile->winner[cell] >> 2, left = slots;
#if EXACT
    mask unclear = (mask)(0);
#endif
    for (int lane = 0; lane < LANES; lane++) {
        integer slot = LANE(integer, left, lane);
        if (slot == MISS)
            continue;
        mask mine = slots == (mask)(slot);
        left = mine ? (mask)(MISS) : left;
        __global const slot_record *r = in->slots + slot;
        if (r->general >= 0)
            continue;
        reals root = tile->root[cell], root_error = (reals)(0);
#if EXACT
        root_error = simple_root_error(r, root);
        tile->error[cell] = mine ? r->key_error + root_error : tile->error[cell];
        unclear |= mine & unclear_root(r, root);
#endif
        if (f->channels & WANT_N)
            n = choose(mine, simple_gradient_at(f, r, root, root_error, u - (real)r->centre[0], v - (real)r->centre[1]), n);
    }
#if EXACT
    note_doubt(tile, cell, unclear, DOUBT_HIT);
#endif
    return n;
}

// Unit normals of all cells. One short loop after another: the processor then works on several cells at once, where one
// long loop waits for each cell's root and quotient.
static void store_normals(__global const frame *f, const window *w, tile_state *tile, const vector3 *gradient,
                          __global float *planes)
{
    reals scale[CELLS];
    for (int cell = 0; cell < CELLS; cell++) {
        vector3 n = gradient[cell];
        reals square = n.x * n.x + n.y * n.y + n.z * n.z;
        scale[cell] = tile->winner[cell] != MISS ? square : (reals)(1);
    }
    for (int cell = 0; cell < CELLS; cell++)
        scale[cell] = inverse_length(scale[cell]);
    floats out[3][CELLS] ALIGNED;
    for (int cell = 0; cell < CELLS; cell++) {
        mask hit = tile->winner[cell] != MISS;
        vector3 n = gradient[cell];
        reals to_unit = scale[cell];
#if EXACT
        reals x = nearest_step(n.x, to_unit), y = nearest_step(n.y, to_unit), z = nearest_step(n.z, to_unit);
        // Scaling to unit length what is off by e moves it by at most e / (|n| - e); then come ten roundings.
        reals slack = (0.5 * NORMAL_STEP - 12 * UNIT_ROUNDOFF) - 1.01 * n.error * to_unit;
        mask certain = (magnitude(n.x * to_unit - x) < slack) & (magnitude(n.y * to_unit - y) < slack) &
                       (magnitude(n.z * to_unit - z) < slack);
        note_doubt(tile, cell, hit & ~certain, DOUBT_NORMAL);
#else
        // -0 + 0 is +0.
        reals x = n.x * to_unit + 0, y = n.y * to_unit + 0, z = n.z * to_unit + 0;
#endif
        out[0][cell] = TO_FLOATS(hit ? x : (reals)(0));
        out[1][cell] = TO_FLOATS(hit ? y : (reals)(0));
        out[2][cell] = TO_FLOATS(hit ? z : (reals)(0));
    }
    for (int j = 0; j < 3; j++)
        store_tile(w, plane_of(f, w, planes, WANT_N) + j * w->plane_size, (__private const float *)out[j]);
}

static void finish_winners(__global const frame *f, const window *w, tile_state *tile, const lists *in,
                           __global float *planes)
{
    int want_normals = f->channels & WANT_N;
    vector3 gradient[CELLS];
    if (in->general_count > 0)
        general_gradients(f, tile, in, gradient);
    for (int cell = 0; cell < CELLS && in->simple_count > 0; cell++) {
        reals u = in->ramp + (real)(cell % VECTORS * LANES + in->u0 + TILE / 2);
        real v = cell / VECTORS + in->v0 + (real)0.5;
        vector3 none = {(reals)(0), (reals)(0), (reals)(0)};
        gradient[cell] = simple_gradients(f, tile, in, cell, u, v, in->general_count > 0 ? gradient[cell] : none);
    }
    if (want_normals)
        store_normals(f, w, tile, gradient, planes);
}

#if !EXACT
#pragma OPENCL FP_CONTRACT OFF
#endif
