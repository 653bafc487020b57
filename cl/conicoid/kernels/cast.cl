// One work-item casts one tile: nearest keys first, then the channels that need the winner's form, then those that
// only need the depth.

// What casting a list needs besides the records.
typedef struct {
    int u0, v0;             // the tile's first pixel
    reals ramp;             // lane centres of the tile's first cell, from its middle
    int orthographic, want_back;
    __global const int *document_order, *surface_class;
} lists;

static int cast_simple(tile_state *tile, __global const simple_record *r, int slot, int4 box, const lists *in)
{
    const real half_tile = TILE / 2;
    double du = (in->u0 + TILE / 2) - r->centre[0], dv = (in->v0 + TILE / 2) - r->centre[1];
    quadratic s = move_quadratic(r->s, du, dv);
    int y0 = max(box.y - in->v0, 0), y1 = min(box.w - in->v0, TILE);
    int c0 = max(box.x - in->u0, 0) / LANES, c1 = min((box.z - in->u0 + LANES - 1) / LANES, VECTORS);
#if EXACT
    simple_error error = simple_error_of(r, du, dv);
    if (!(error.s < 0x1p500 && error.b < 0x1p500)) {
        // A record out of range says nothing: every pixel of its box is in doubt.
        for (int y = y0; y < y1; y++)
            for (int c = c0; c < c1; c++)
                note_doubt(tile, y * VECTORS + c, (mask)(-1), DOUBT_HIT);
        return 1;
    }
    // S raised by its error: what is negative now is a miss, and a root too near zero shows in the winner.
    s.one += 0.5 * error.s;
    // A key's error: that of b, of a root no smaller than the error of S, and two roundings.
    real slop = error.b + sqrt(error.s) + 4 * UNIT_ROUNDOFF * sqrt(error.s * (1 / (40 * UNIT_ROUNDOFF)));
    if (highest_quadratic(s, half_tile) < -error.s)
        return 0;
#else
    const real slop = 0;
    if (highest_quadratic(s, half_tile) * (real)1.0000001 < 0)
        return 0;
#endif
    linear b = move_linear(r->b, du, dv);
    const real shrink = (real)(1 - 0x1p-20);
    mask challenger = (mask)((integer)slot << 2);
    int improved = 0;
    for (int y = y0; y < y1; y++) {
        real py = y + (real)0.5 - half_tile;
        real s_row = (s.vv * py + s.v) * py + s.one;
        real s_slope = s.uv * py + s.u;
        real b_row = b.v * py + b.one;
        for (int c = c0; c < c1; c++) {
            reals x = in->ramp + (real)(c * LANES);
            reals at = (s.uu * x + s_slope) * x + s_row;
            int cell = y * VECTORS + c;
            // key > best needs sqrt(S) > best - b: squared, this spares the root of what is hidden. The slack keeps
            // every key that could still tie.
            reals lead = b.u * x + b_row;
#if EXACT
            reals needed = (tile->key[cell] - (slop + tile->slop[cell])) - lead;
            // Negated, so that bounds out of range leave everything in doubt.
            mask plausible = ~((at < 0) | ((needed > 0) & (at + 4 * error.s < needed * needed)));
#else
            reals needed = (tile->key[cell] - lead) * shrink;
            mask plausible = (at >= 0) & ((needed <= 0) | (at >= needed * needed));
#endif
            if (!some(plausible))
                continue;
            reals root = sqrt(at);
            // NaN, and so never better, where S is negative.
            reals key = lead + root;
            offer(tile, cell, key, (reals)(slop), root, challenger, in->document_order, in->surface_class);
            improved = 1;
        }
    }
    return improved;
}

static int cast_general(tile_state *tile, const general_tile *g, int slot, int4 box, const lists *in)
{
    const real half_tile = TILE / 2;
#if EXACT
    if (!(g->flags & (HAS_CAPS | ALWAYS_REAL)) && highest_quadratic(g->s, half_tile) < -2 * g->s.error)
        return 0;
#else
    if (!(g->flags & (HAS_CAPS | ALWAYS_REAL)) && highest_quadratic(g->s, half_tile) * (real)1.0000001 < 0)
        return 0;
#endif
    int y0 = max(box.y - in->v0, 0), y1 = min(box.w - in->v0, TILE);
    int c0 = max(box.x - in->u0, 0) / LANES, c1 = min((box.z - in->u0 + LANES - 1) / LANES, VECTORS);
    int improved = 0;
    for (int y = y0; y < y1; y++)
        for (int c = c0; c < c1; c++) {
            int cell = y * VECTORS + c;
            hits h = candidates(g, in->ramp + (real)(c * LANES), y + (real)0.5 - half_tile);
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
            mask better = offer(tile, cell, key, slop, (reals)(0), h.kind | (mask)((integer)slot << 2),
                                in->document_order, in->surface_class);
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

static inline real farthest_key(const tile_state *tile)
{
    reals m = tile->key[0];
    for (int cell = 1; cell < CELLS; cell++)
        m = tile->key[cell] < m ? tile->key[cell] : m;
    return lowest(m);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void cast_tiles(__global const frame *f, __global const int *tile_end, __global const int *list,
                __global const int4 *box, __global const double *nearest_key, __global const int *record_of,
                __global const int *document_order, __global const int *surface_class, __global const uint *id,
                __global const simple_record *simple, __global const general_record *general,
                __global const clip_record *clips, __global float *planes, __global uint *ids,
                __global int *doubt_count, __global doubtful_pixel *doubts)
{
    int tile_index = get_global_id(1) * f->columns + get_global_id(0);
    int u0 = (f->tile_origin[0] + (int)get_global_id(0)) * TILE, v0 = (f->tile_origin[1] + (int)get_global_id(1)) * TILE;
    window w = window_of(f, u0, v0);
    int begin = tile_index == 0 ? 0 : tile_end[tile_index - 1], end = tile_end[tile_index];
    if (begin == end) {
        store_background(f, &w, planes, ids);
        return;
    }
    tile_state tile;
    real empty = f->orthographic ? -INFINITY : 0;
#if EXACT
    tile.any_doubt = (mask)(0);
#endif
    for (int cell = 0; cell < CELLS; cell++) {
        tile.key[cell] = (reals)(empty);
        tile.winner[cell] = (mask)(MISS);
#if EXACT
        tile.slop[cell] = (reals)(0);
        tile.doubt[cell] = (mask)(0);
#endif
    }
    lists in = {u0, v0, (reals)(0), f->orthographic, f->channels & WANT_ZBACK, document_order, surface_class};
    for (int lane = 0; lane < LANES; lane++)
        LANE(real, in.ramp, lane) = lane + (real)0.5 - TILE / 2;

    real near = (real)f->near, far = (real)f->far;
    real farthest = empty;
    int hit = 0, stale = 0;
    for (int k = begin; k < end; k++) {
        int slot = list[k];
        if (stale && (k & 7) == 0) {
            farthest = farthest_key(&tile);
            stale = 0;
        }
        // The list is in depth order, its bounds widened: nothing behind every pixel can win, or tie.
        if ((real)nearest_key[slot] < farthest)
            break;
        int record = record_of[slot];
        if (record >= 0) {
            stale |= cast_simple(&tile, simple + record, slot, box[slot], &in);
        } else {
            general_tile g = move_general(general + ~record, clips, u0 + TILE / 2, v0 + TILE / 2, near, far);
            stale |= cast_general(&tile, &g, slot, box[slot], &in);
        }
        hit |= stale;
    }
    if (!hit) {
        store_background(f, &w, planes, ids);
        return;
    }
    if (EXACT || (f->channels & WANT_N))
        store_form_channels(f, &w, &tile, in.ramp, record_of, simple, general, clips, near, far, planes);
    store_depth_channels(f, &w, &tile, in.ramp, id, planes, ids);
#if EXACT
    list_doubts(f, &w, &tile, doubt_count, doubts);
#endif
}
