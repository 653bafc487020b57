// Casting simple records, and the normals of their winners.

// Fused whatever the precision.
#pragma OPENCL FP_CONTRACT ON

static int cast_simple(tile_state *tile, __global const slot_record *r, int slot, const lists *in)
{
    const real half_tile = TILE / 2;
    int y0 = max(r->box[1] - in->v0, 0), y1 = min(r->box[3] - in->v0, TILE);
    int c0 = max(r->box[0] - in->u0, 0) / LANES, c1 = min((r->box[2] - in->u0 + LANES - 1) / LANES, VECTORS);
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
    if (max(r->box[2] - r->box[0], r->box[3] - r->box[1]) > TILE && highest_quadratic(move_quadratic(r->s, du, dv), half_tile) + raise < 0)
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

// A winner's outward gradient in target space, up to a factor, at the pixel (x, y) from its record's centre: by the chain
// rule, of root b + S / 2 in u, v and depth (records.h).
static inline vector3 simple_gradient_at(__global const frame *f, __global const slot_record *r, reals root, reals root_error,
                                         reals x, real y)
{
    real uv = (real)0.5 * (real)r->s[1], u = (real)0.5 * (real)r->s[3], v = (real)0.5 * (real)r->s[4];
    reals along_u = ((real)r->s[0] * x + (uv * y + u)) + (real)r->b[0] * root;
    reals along_v = (uv * x + ((real)r->s[2] * y + v)) + (real)r->b[1] * root;
    reals deeper = root;
    if (!f->orthographic) {
        deeper = (u * x + (v * y + (real)r->s[5])) + (real)r->b[2] * root;
        deeper += (real)(f->principal[0] - r->centre[0]) * along_u + (real)(f->principal[1] - r->centre[1]) * along_v;
    }
    vector3 n;
    n.x = (real)f->axes[0][0] * along_u + ((real)f->axes[1][0] * along_v + (real)f->axes[2][0] * deeper);
    n.y = (real)f->axes[0][1] * along_u + ((real)f->axes[1][1] * along_v + (real)f->axes[2][1] * deeper);
    n.z = (real)f->axes[0][2] * along_u + ((real)f->axes[1][2] * along_v + (real)f->axes[2][2] * deeper);
#if EXACT
    n.error = r->n_error + r->root_norm * root_error;
#endif
    return n;
}

#if EXACT
// From a square root of 8 errors on, S is no less than 6 of them for certain, and sqrt(S) no less than 0.86 of the root:
// it is wrong by at most 2 e / (1.86 root). In binary32, rounded up; what underflows is replaced by something larger.
static inline reals simple_root_error(__global const slot_record *r, reals root)
{
    return FROM_FLOATS((floats)(r->s_error * 1.08f + 0x1p-120f) / TO_FLOATS(root));
}

static inline mask unclear_root(__global const slot_record *r, reals root) { return ~(root * root >= (real)(8.01 * r->s_error)); }
#endif

#if !EXACT
#pragma OPENCL FP_CONTRACT OFF
#endif
