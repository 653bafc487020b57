// Casting general records.

// The strips of a record that cross a tile, about its middle.
typedef struct {
    int count;
    real u[3], v[3], low[3], high[3];
} strips;

// Returns whether the tile is within reach of all.
static inline int cut_by(__global const general_record *r, double du, double dv, strips *out)
{
    out->count = 0;
    for (int k = 0; k < 3; k++) {
        double u = r->slab[k][0], v = r->slab[k][1], middle = u * du + v * dv, reach = (TILE / 2) * (fabs(u) + fabs(v));
        double low = r->slab[k][2] - middle, high = r->slab[k][3] - middle;
        if (low > reach || high < -reach)
            return 0;
        if (low > -reach || high < reach) {
            out->u[out->count] = (real)u;
            out->v[out->count] = (real)v;
            out->low[out->count] = (real)low;
            out->high[out->count++] = (real)high;
        }
    }
    return 1;
}

static inline mask in_strips(const strips *s, reals x, real y)
{
    mask inside = (mask)(-1);
    for (int k = 0; k < s->count; k++) {
        reals at = s->u[k] * x + s->v[k] * y;
        inside &= (at >= s->low[k]) & (at <= s->high[k]);
    }
    return inside;
}

static int cast_general(tile_state *tile, __global const slot_record *r, int slot, lists *in)
{
    const real half_tile = TILE / 2;
    __global const general_record *form = in->general + r->general;
    double middle_u = in->u0 + TILE / 2, middle_v = in->v0 + TILE / 2;
    strips edges;
    if (!cut_by(form, middle_u - form->centre[0], middle_v - form->centre[1], &edges))
        return 0;
    general_tile tile_form = move_general(form, in->clips, middle_u, middle_v, in->near, in->far, !in->want_back);
    const general_tile *g = &tile_form;
    in->general_count++;
#if EXACT
    tile_form.where = (places){in->where.of + 4 * slot, in->where.known};
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
            mask asked = ((reals)((real)r->nearest) >= bar) & in_strips(&edges, x, py);
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
