// Casting general records.

static int cast_general(tile_state *tile, __global const slot_record *r, int slot, lists *in)
{
    const real half_tile = TILE / 2;
    __global const general_record *form = in->general + r->general;
    double middle_u = in->u0 + TILE / 2, middle_v = in->v0 + TILE / 2;
    strips edges;
    if (!cut_by(form, middle_u - form->centre[0], middle_v - form->centre[1], &edges))
        return 0;
    general_tile tile_form = move_general(form, in->clips, middle_u, middle_v, in->near, in->far);
    tile_form.first_only = !in->want_back && !(tile_form.flags & SHEETS) && !tile_form.placed;
    const general_tile *g = &tile_form;
    in->general_count++;
#if EXACT
    tile_form.where = (places){in->where.of + 4 * slot, in->where.known};
    real noise = 2 * g->s.error;
#else
    real noise = 0;
#endif
    if (!(g->flags & ALWAYS_REAL) && !beyond_roots(g) && highest_quadratic(g->s, half_tile) < -noise)
        return 0;
    move_clips(&tile_form);
    if (!within_reach(g))
        return 0;
    int y0 = max(r->box[1] - in->v0, 0), y1 = min(r->box[3] - in->v0, TILE);
    int c0 = max(r->box[0] - in->u0, 0) / LANES, c1 = min((r->box[2] - in->u0 + LANES - 1) / LANES, VECTORS);
    int improved = 0;
    for (int y = y0; y < y1; y++) {
        real py = y + (real)0.5 - half_tile;
        int begin = c0, end = c1;
        narrow(&edges, py, &begin, &end);
        for (int c = begin; c < end; c++) {
            int cell = y * VECTORS + c;
            reals x = in->ramp + (real)(c * LANES);
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
            farthest = (in->orthographic ? (mask)(-1) : bar > 0) ? farthest : (reals)(INFINITY);
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
    }
    return improved;
}
