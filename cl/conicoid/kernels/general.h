// Casting general records.

// What of a tile a record's strips leave, row by row.
typedef struct {
    int count;
    real v[3], low[3], high[3];     // of x, over v y
} strips;

// Returns whether all of them reach the tile.
static inline int cut_by(__global const general_record *r, double du, double dv, strips *out)
{
    out->count = 0;
    for (int k = 0; k < 3; k++) {
        double u = r->slab[k][0], v = r->slab[k][1], middle = u * du + v * dv, reach = (TILE / 2) * (fabs(u) + fabs(v));
        double low = r->slab[k][2] - middle, high = r->slab[k][3] - middle;
        if (low > reach || high < -reach)
            return 0;
        // One along the rows cuts none of them in two.
        if ((low > -reach || high < reach) && fabs(u) > 1e-3) {
            double per_u = 1.0 / u;
            out->v[out->count] = (real)(v * per_u);
            out->low[out->count] = (real)((u > 0.0 ? low : high) * per_u);
            out->high[out->count++] = (real)((u > 0.0 ? high : low) * per_u);
        }
    }
    return 1;
}

// Narrows the cells [c0, c1) of the row at y.
static inline void narrow(const strips *s, real y, int *c0, int *c1)
{
    const real first = (TILE - 1) / (real)2;
    real low = -first, high = first;
    for (int k = 0; k < s->count; k++) {
        real along = s->v[k] * y;
        low = max(low, s->low[k] - along);
        high = min(high, s->high[k] - along);
    }
    if (low > high) {
        *c1 = 0;
        return;
    }
    *c0 = max(*c0, (int)(low + first) / LANES);
    *c1 = min(*c1, (int)(high + first) / LANES + 1);
}

static void move_clips(general_tile *g)
{
    g->first_moved = g->clip_start[0];
    g->moved = min(g->clip_count[0], MOST_MOVED);
    for (int k = 0; k < g->moved; k++) {
        g->offset[k] = move_linear(g->clips[g->first_moved + k].offset, g->tile_u, g->tile_v);
        g->slope[k] = move_linear(g->clips[g->first_moved + k].slope, g->tile_u, g->tile_v);
    }
}

// The depths at which anything is kept somewhere on the tile.
typedef struct {
    real low, high;
} stretch;

// Cuts off the depths t > 0 where side (offset + t slope) < 0 on all of the tile.
static inline stretch keep_side(stretch s, const linear *offset, const linear *slope, real side)
{
    const real h = TILE / 2;
    real most = side * offset->one + h * (fabs(offset->u) + fabs(offset->v));
    real steepest = side * slope->one + h * (fabs(slope->u) + fabs(slope->v));
#if EXACT
    most += 2 * offset->error;
    steepest += 2 * slope->error;
#endif
    if (steepest > 0)
        s.low = most < 0 ? max(s.low, -most / steepest) : s.low;
    else if (most < 0)
        s.high = -1;
    else if (steepest < 0)
        s.high = min(s.high, -most / steepest);
    return s;
}

// Whether some depth is inside the range and on the right side of all clips.
static inline int within_reach(const general_tile *g)
{
    if (g->placed)
        return 1;
    stretch s = {g->near, g->far};
    for (int k = 0; k < g->moved; k++)
        s = keep_side(s, &g->offset[k], &g->slope[k], 1);
    for (int side = 0; side < ((g->flags & HAS_RANGE) ? 2 : 0); side++)
        s = keep_side(s, &g->range[side], &g->height, side == 0 ? 1 : -1);
    return !(s.low * (real)(1 - 1e-5) > s.high);
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
    real noise = 2 * g->s.error;
#else
    real noise = 0;
#endif
    if (!(g->flags & ALWAYS_REAL) && !beyond_roots(g) && highest_quadratic(g->s, half_tile) * (real)1.0000001 < -noise)
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
