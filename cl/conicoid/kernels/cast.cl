// One work-item casts one tile: nearest keys first, then the channels that only need the depth, then those that need
// the winner's form.

// Where keys tie the earlier quadric of the document wins.
static inline mask earlier_at_ties(mask tied, mask winner, int slot, __global const int *document_order)
{
    if (!some(tied))
        return tied;
    for (int lane = 0; lane < LANES; lane++)
        if (LANE(integer, tied, lane) &&
            document_order[slot] > document_order[LANE(integer, winner, lane) >> 2])
            LANE(integer, tied, lane) = 0;
    return tied;
}

static inline int offer(tile_state *tile, int cell, reals key, reals root, mask kind, int slot,
                        __global const int *document_order)
{
    mask better = key > tile->key[cell];
    mask tied = key == tile->key[cell];
    better |= earlier_at_ties(tied & (tile->winner[cell] != MISS), tile->winner[cell], slot, document_order);
    tile->key[cell] = better ? key : tile->key[cell];
    tile->root[cell] = better ? root : tile->root[cell];
    tile->winner[cell] = better ? (kind | (mask)((integer)slot << 2)) : tile->winner[cell];
    return 1;
}

static int cast_simple(tile_state *tile, __global const simple_record *r, int slot, int4 box, int u0, int v0,
                       reals ramp, __global const int *document_order)
{
    const real half_tile = TILE / 2;
    double du = (u0 + TILE / 2) - r->centre[0], dv = (v0 + TILE / 2) - r->centre[1];
    quadratic s = move_quadratic(r->s, du, dv);
    if (highest_quadratic(s, half_tile) * (real)1.0000001 < 0)
        return 0;
    linear b = move_linear(r->b, du, dv);
    int y0 = max(box.y - v0, 0), y1 = min(box.w - v0, TILE);
    int c0 = max(box.x - u0, 0) / LANES, c1 = min((box.z - u0 + LANES - 1) / LANES, VECTORS);
    const real slack = (real)(1 - 0x1p-20);
    int improved = 0;
    for (int y = y0; y < y1; y++) {
        real py = y + (real)0.5 - half_tile;
        real s_row = (s.vv * py + s.v) * py + s.one;
        real s_slope = s.uv * py + s.u;
        real b_row = b.v * py + b.one;
        for (int c = c0; c < c1; c++) {
            reals x = ramp + (real)(c * LANES);
            reals at = (s.uu * x + s_slope) * x + s_row;
            int cell = y * VECTORS + c;
            // key > best needs sqrt(S) > best - b: squared, this spares the root of what is hidden. The slack keeps
            // every key that could still tie.
            reals lead = b.u * x + b_row;
            reals needed = (tile->key[cell] - lead) * slack;
            if (!some((at >= 0) & ((needed <= 0) | (at >= needed * needed))))
                continue;
            reals root = sqrt(at);
            reals key = lead + root;
            // NaN keys, of negative S, compare false.
            if (some(key >= tile->key[cell]))
                improved |= offer(tile, cell, key, root, (mask)(0), slot, document_order);
        }
    }
    return improved;
}

static int cast_general(tile_state *tile, const general_tile *g, int slot, int4 box, int u0, int v0, reals ramp,
                        int orthographic, __global const int *document_order)
{
    const real half_tile = TILE / 2;
    if (!(g->flags & (HAS_CAPS | ALWAYS_REAL)) && highest_quadratic(g->s, half_tile) * (real)1.0000001 < 0)
        return 0;
    int y0 = max(box.y - v0, 0), y1 = min(box.w - v0, TILE);
    int c0 = max(box.x - u0, 0) / LANES, c1 = min((box.z - u0 + LANES - 1) / LANES, VECTORS);
    int improved = 0;
    for (int y = y0; y < y1; y++)
        for (int c = c0; c < c1; c++) {
            int cell = y * VECTORS + c;
            hits h = candidates(g, ramp + (real)(c * LANES), y + (real)0.5 - half_tile);
            mask hit = h.first < INFINITY;
            if (!some(hit))
                continue;
            reals key = orthographic ? -h.first : 1 / h.first;
            key = hit ? key : (reals)(-INFINITY);
            if (some(hit & (key >= tile->key[cell])))
                improved |= offer(tile, cell, key, (reals)(0), h.kind, slot, document_order);
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
                __global const int *document_order, __global const uint *id,
                __global const simple_record *simple, __global const general_record *general,
                __global const clip_record *clips, __global float *planes, __global uint *ids)
{
    const real half_tile = TILE / 2;
    int tile_index = get_global_id(1) * f->columns + get_global_id(0);
    int u0 = (f->tile_origin[0] + (int)get_global_id(0)) * TILE, v0 = (f->tile_origin[1] + (int)get_global_id(1)) * TILE;
    window w = window_of(f, u0, v0);
    int begin = tile_index == 0 ? 0 : tile_end[tile_index - 1], end = tile_end[tile_index];
    if (begin == end) {
        store_background(f, &w, planes, ids);
        return;
    }
    int orthographic = f->orthographic;
    tile_state tile;
    real empty = orthographic ? -INFINITY : 0;
    for (int cell = 0; cell < CELLS; cell++) {
        tile.key[cell] = (reals)(empty);
        tile.winner[cell] = (mask)(MISS);
    }
    reals ramp;
    for (int lane = 0; lane < LANES; lane++)
        LANE(real, ramp, lane) = lane + (real)0.5 - half_tile;

    real near = (real)f->near, far = (real)f->far;
    real farthest = empty;
    int hit = 0, stale = 0;
    for (int k = begin; k < end; k++) {
        int slot = list[k];
        if (stale && (k & 7) == 0) {
            farthest = farthest_key(&tile);
            stale = 0;
        }
        // The list is in depth order: nothing behind every pixel can win.
        if ((real)nearest_key[slot] < farthest)
            break;
        int record = record_of[slot];
        if (record >= 0) {
            stale |= cast_simple(&tile, simple + record, slot, box[slot], u0, v0, ramp, document_order);
        } else {
            general_tile g = move_general(general + ~record, clips, u0 + TILE / 2, v0 + TILE / 2, near, far);
            stale |= cast_general(&tile, &g, slot, box[slot], u0, v0, ramp, orthographic, document_order);
        }
        hit |= stale;
    }
    if (!hit) {
        store_background(f, &w, planes, ids);
        return;
    }
    store_depth_channels(f, &w, &tile, ramp, id, planes, ids);
    if (f->channels & (WANT_N | WANT_ZBACK))
        store_form_channels(f, &w, &tile, ramp, record_of, simple, general, clips, near, far, planes);
}
