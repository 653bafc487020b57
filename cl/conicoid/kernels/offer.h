// Keeping the nearest key of every pixel.

// What casting a list needs.
typedef struct {
    int u0, v0;             // the tile's first pixel
    reals ramp;             // lane centres of the tile's first cell, from its middle
    int orthographic, want_back;
    int general_count, simple_count;    // of the tile's candidates so far
    real near, far;
    __global const slot_record *slots;
    __global const general_record *general;
    __global const clip_record *clips;
#if EXACT
    places where;
#endif
} lists;

// Where keys tie the earlier quadric of the document wins. In EXACT casting a tie is a difference within the errors of
// both keys; only surfaces whose places are known may tie without doubt.
__attribute__((noinline)) static mask settle_ties(tile_state *tile, int cell, mask tied, mask better, mask challenger,
                                                  const lists *in)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (!LANE(integer, tied, lane))
            continue;
        int old = (int)LANE(integer, tile->winner[cell], lane), new = (int)LANE(integer, challenger, lane);
        if (old == MISS) {
            LANE(integer, better, lane) = -1;
            continue;
        }
#if EXACT
        double u = in->u0 + cell % VECTORS * LANES + lane + 0.5, v = in->v0 + cell / VECTORS + 0.5;
        int order = nearer_place(in->where, in->where.of[old], in->where.of[new], u, v);
        if (order == OPEN) {
            integer rival = LANE(integer, better, lane) ? old : new;
            integer reasons = LANE(integer, tile->doubt[cell], lane) & 0xff;
            LANE(integer, tile->doubt[cell], lane) = (rival + 1) << 32 | reasons | DOUBT_HIT;
            tile->doubtful = 1;
            continue;
        }
        if (order != SAME) {
            LANE(integer, better, lane) = order == NEARER ? -1 : 0;
            continue;
        }
#endif
        LANE(integer, better, lane) = in->slots[new >> 2].quadric < in->slots[old >> 2].quadric ? -1 : 0;
    }
    return better;
}

// A key that `slop` more cannot bring here is behind the winner for certain.
static inline reals bar_of(const tile_state *tile, int cell, reals slop)
{
#if EXACT
    return tile->bar[cell] - slop;
#else
    // The slack keeps keys that tie but for rounding.
    return tile->key[cell] - magnitude(tile->key[cell]) * (real)0x1p-20;
#endif
}

// Returns the lanes where the challenger is now the winner. `plausible`: those whose key is no less than bar_of.
static inline mask offer(tile_state *tile, int cell, mask plausible, reals key, reals slop, reals root, mask challenger,
                         const lists *in)
{
    reals best = tile->key[cell];
#if EXACT
    // A plausible key is better for certain or ties: |key - best| <= slop + (best - bar).
    reals bar = tile->bar[cell], low = key - slop;
    mask better = plausible & (low > 2 * best - bar), tied = plausible & ~better;
#else
    mask better = key > best, tied = plausible & (key == best);
#endif
    if (some(tied))
        better = settle_ties(tile, cell, tied, better, challenger, in);
    tile->key[cell] = better ? key : best;
    tile->root[cell] = better ? root : tile->root[cell];
    tile->winner[cell] = better ? challenger : tile->winner[cell];
#if EXACT
    tile->bar[cell] = better ? low : bar;
#endif
    return better;
}
