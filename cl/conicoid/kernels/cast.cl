// One work-item casts one tile: nearest keys first, then the channels that need the winner's form, then those that
// only need the depth.

#define AHEAD 6

static inline real farthest_key(const tile_state *tile)
{
    reals m = tile->key[0];
    for (int cell = 1; cell < CELLS; cell++)
        m = tile->key[cell] < m ? tile->key[cell] : m;
    return lowest(m);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void cast_tiles(__global const frame *f, __global const int *tile_end, __global const int *list,
                __global const slot_record *slots, __global const general_record *general,
                __global const clip_record *clips, __global const int *place_of, __global const plane_record *known,
                __global const uint *id, __global float *planes, __global uint *ids, __global int *doubt_count,
                __global doubtful_pixel *doubts)
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
    // Behind everything, and finite: what is certain is told by differences.
    real empty = f->orthographic ? (real)-0x1p1000 : 0;
#if EXACT
    tile.doubtful = 0;
#endif
    for (int cell = 0; cell < CELLS; cell++) {
        tile.key[cell] = (reals)(empty);
        tile.winner[cell] = (mask)(MISS);
#if EXACT
        tile.bar[cell] = (reals)(empty);
        tile.doubt[cell] = (mask)(0);
#endif
    }
    lists in = {.u0 = u0, .v0 = v0, .orthographic = f->orthographic, .want_back = f->channels & WANT_ZBACK,
                .near = (real)f->near, .far = (real)f->far, .slots = slots, .general = general, .clips = clips};
#if EXACT
    in.where = (places){place_of, known};
#endif
    for (int lane = 0; lane < LANES; lane++)
        LANE(real, in.ramp, lane) = lane + (real)0.5 - TILE / 2;

    real farthest = empty;
    int hit = 0, stale = 0;
    for (int k = begin; k < end; k++) {
        int slot = list[k];
        if (stale && (k & 7) == 0) {
            farthest = farthest_key(&tile);
            stale = 0;
        }
        // Scenes of many quadrics wait for memory here more than for all else.
        if (k + AHEAD < end) {
            __builtin_prefetch(slots + list[k + AHEAD]);
            __builtin_prefetch((__global const char *)(slots + list[k + AHEAD]) + 64);
        }
        if (k + 2 < end && slots[list[k + 2]].general >= 0)
            for (int line = 0; line < 10; line++)
                __builtin_prefetch((__global const char *)(general + slots[list[k + 2]].general) + 64 * line);
        __global const slot_record *r = slots + slot;
        // The list is in depth order, its bounds widened: nothing behind every pixel can win, or tie.
        if ((real)r->nearest < farthest)
            break;
        if (r->general < 0) {
            stale |= cast_simple(&tile, r, slot, &in);
            in.simple_count++;
        } else {
            stale |= cast_general(&tile, r, slot, &in);
        }
        hit |= stale;
    }
    if (!hit) {
        store_background(f, &w, planes, ids);
        return;
    }
    if (EXACT || (f->channels & WANT_N))
        finish_winners(f, &w, &tile, &in, planes);
    store_depth_channels(f, &w, &tile, &in, id, planes, ids);
#if EXACT
    if (tile.doubtful)
        list_doubts(f, &w, &tile, doubt_count, doubts);
#endif
}
