// Casting simple records, and the normals of their winners.

// Products and sums may be fused here: error bounds count both roundings, and what is written is certified.
#pragma OPENCL FP_CONTRACT ON

static int cast_simple(tile_state *tile, __global const simple_record *r, int slot, int4 box, const lists *in)
{
    const real half_tile = TILE / 2;
    int y0 = max(box.y - in->v0, 0), y1 = min(box.w - in->v0, TILE);
    int c0 = max(box.x - in->u0, 0) / LANES, c1 = min((box.z - in->u0 + LANES - 1) / LANES, VECTORS);
    double du = (in->u0 + TILE / 2) - r->centre[0], dv = (in->v0 + TILE / 2) - r->centre[1];
#if EXACT
    const real slop = r->slop, raise = r->s_error;
    if (!(slop < 0x1p500)) {
        // A record out of range says nothing: every pixel of its box is in doubt.
        for (int y = y0; y < y1; y++)
            for (int c = c0; c < c1; c++)
                note_doubt(tile, y * VECTORS + c, (mask)(-1), DOUBT_HIT);
        return 1;
    }
#else
    const real slop = 0, raise = 0;
#endif
    // Only what is larger than a tile can miss one that its box touches by much.
    if (max(box.z - box.x, box.w - box.y) > TILE && highest_quadratic(move_quadratic(r->s, du, dv), half_tile) + raise < 0)
        return 0;
    quadratic s = local_quadratic(r->s, du, dv);
    linear b = local_linear(r->b, du, dv);
    // S raised by its error: what is negative now is a miss, and a root too near zero shows in the winner.
    s.one += raise;
    reals ramp = in->ramp + (real)LOCAL(du);
    mask challenger = (mask)((integer)slot << 2);
    int improved = 0;
    for (int y = y0; y < y1; y++) {
        real py = y + (real)0.5 - half_tile + (real)LOCAL(dv);
        real s_row = (s.vv * py + s.v) * py + s.one;
        real s_slope = s.uv * py + s.u;
        real b_row = b.v * py + b.one;
        for (int c = c0; c < c1; c++) {
            reals x = ramp + (real)(c * LANES);
            reals at = (s.uu * x + s_slope) * x + s_row;
            reals lead = b.u * x + b_row;
            int cell = y * VECTORS + c;
            // key >= bar needs sqrt(S) >= bar - b: squared, this spares the root of what is hidden.
            reals needed = bar_of(tile, cell, slop) - lead;
            needed = needed > 0 ? needed : (reals)(0);
            mask plausible = at >= needed * needed;
            if (!some(plausible))
                continue;
            reals root = sqrt(at);
            // NaN, and so never better, where S is negative.
            offer(tile, cell, plausible, lead + root, (reals)(slop), root, challenger, in);
            improved = 1;
        }
    }
    return improved;
}

// A winner's outward normal at offsets from its record's centre.
static inline vector3 simple_normal_at(__global const simple_normal_record *m, reals root, reals root_error, reals u, real v)
{
    vector3 n;
    n.x = ((real)m->n[0][0] * u + ((real)m->n[0][1] * v + (real)m->n[0][2])) + (real)m->g[0] * root;
    n.y = ((real)m->n[1][0] * u + ((real)m->n[1][1] * v + (real)m->n[1][2])) + (real)m->g[1] * root;
    n.z = ((real)m->n[2][0] * u + ((real)m->n[2][1] * v + (real)m->n[2][2])) + (real)m->g[2] * root;
#if EXACT
    n.error = m->n_error + m->g_norm * root_error;
#endif
    return n;
}

#if EXACT
// From a square root of 8 errors on, S is no less than 6 of them for certain, and sqrt(S) no less than 0.86 of the root:
// it is wrong by at most 2 e / (1.86 root). In binary32, rounded up; what underflows is replaced by something larger.
static inline reals simple_root_error(__global const simple_record *r, reals root)
{
    return FROM_FLOATS((floats)((float)r->s_error * 1.08f + 0x1p-120f) / TO_FLOATS(root));
}

static inline mask unclear_root(__global const simple_record *r, reals root) { return ~(root * root >= 8.01 * r->s_error); }
#endif

#pragma OPENCL FP_CONTRACT OFF
