// Casting general records.

static int cast_general(tile_state *tile, const general_tile *g, int slot, __global const slot_record *r, const lists *in)
{
    const real half_tile = TILE / 2;
#if EXACT
    if (!(g->flags & (HAS_CAPS | ALWAYS_REAL)) && highest_quadratic(g->s, half_tile) < -2 * g->s.error)
        return 0;
#else
    if (!(g->flags & (HAS_CAPS | ALWAYS_REAL)) && highest_quadratic(g->s, half_tile) * (real)1.0000001 < 0)
        return 0;
#endif
    int y0 = max(r->box[1] - in->v0, 0), y1 = min(r->box[3] - in->v0, TILE);
    int c0 = max(r->box[0] - in->u0, 0) / LANES, c1 = min((r->box[2] - in->u0 + LANES - 1) / LANES, VECTORS);
    int improved = 0;
    for (int y = y0; y < y1; y++)
        for (int c = c0; c < c1; c++) {
            int cell = y * VECTORS + c;
            reals x = in->ramp + (real)(c * LANES);
            real py = y + (real)0.5 - half_tile;
            reals bar = bar_of(tile, cell, (reals)(0));
            mask asked = (reals)((real)r->nearest) >= bar;
            if (!some(asked))
                continue;
            reals s = at_quadratic(g->s, x, py);
            asked &= may_meet(g, s, x, py);
            if (!some(asked))
                continue;
            // A hit beyond this is behind the winner, whatever the rounding.
            reals farthest = in->orthographic ? magnitude(bar) * (real)1e-6 - bar : (real)(1 + 1e-6) / bar;
            farthest = in->want_back ? (reals)(INFINITY) : farthest;
            hits h = candidates(g, s, x, py, asked, farthest);
            mask hit = h.first < INFINITY;
            reals slop = (reals)(0);
#if EXACT
            note_doubt(tile, cell, h.doubt, DOUBT_HIT);
            improved |= some(h.doubt);
            slop = in->orthographic ? h.first_error : 2 * h.first_error / (h.first * h.first);
            slop = hit ? slop : (reals)(0);
#endif
            if (!some(hit))
                continue;
            reals key = in->orthographic ? -h.first : 1 / h.first;
#if EXACT
            slop += 2 * UNIT_ROUNDOFF * magnitude(key);
#endif
            key = hit ? key : (reals)(-INFINITY);
            mask better = offer(tile, cell, hit & (key >= bar_of(tile, cell, slop)), key, slop, (reals)(0), h.kind | (mask)((integer)slot << 2), in);
            if (in->want_back) {
                tile->last[cell] = better ? h.last : tile->last[cell];
#if EXACT
                tile->last_error[cell] = better ? h.last_error : tile->last_error[cell];
#endif
            }
            improved = 1;
        }
    return improved;
}
