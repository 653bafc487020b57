// Keeping the nearest key of every pixel.

#if EXACT
// Surfaces of one class are one set of points: where both are hit they tie, whatever rounding says. -1: of its own.
static inline int same_class(__global const int *surface_class, int first, int second)
{
    int a = surface_class[3 * (first >> 2) + max((first & 3) - 1, 0)];
    return a >= 0 && a == surface_class[3 * (second >> 2) + max((second & 3) - 1, 0)];
}
#endif

// Where keys tie the earlier quadric of the document wins. In EXACT casting a tie is a difference within the errors of
// both keys; only surfaces of one class may tie without doubt.
static mask settle_ties(tile_state *tile, int cell, mask tied, mask better, mask challenger,
                        __global const int *document_order, __global const int *surface_class)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (!LANE(integer, tied, lane))
            continue;
        int old = (int)LANE(integer, tile->winner[cell], lane), new = (int)LANE(integer, challenger, lane);
#if EXACT
        if (!same_class(surface_class, old, new)) {
            integer rival = LANE(integer, better, lane) ? old : new;
            integer reasons = LANE(integer, tile->doubt[cell], lane) & 0xff;
            LANE(integer, tile->doubt[cell], lane) = (rival + 1) << 32 | reasons | DOUBT_HIT;
            LANE(integer, tile->any_doubt, lane) = -1;
            continue;
        }
#endif
        LANE(integer, better, lane) = document_order[new >> 2] < document_order[old >> 2] ? -1 : 0;
    }
    return better;
}

// Returns the lanes where the challenger is now the winner.
static inline mask offer(tile_state *tile, int cell, reals key, reals slop, reals root, mask challenger,
                         __global const int *document_order, __global const int *surface_class)
{
    reals best = tile->key[cell];
    mask better = key > best;
#if EXACT
    reals margin = slop + tile->slop[cell];
    mask tied = (key <= best + margin) & (key >= best - margin) & (tile->winner[cell] != MISS);
#else
    mask tied = (key == best) & (tile->winner[cell] != MISS);
#endif
    if (some(tied))
        better = settle_ties(tile, cell, tied, better, challenger, document_order, surface_class);
    tile->key[cell] = better ? key : best;
    tile->root[cell] = better ? root : tile->root[cell];
    tile->winner[cell] = better ? challenger : tile->winner[cell];
#if EXACT
    tile->slop[cell] = better ? slop : tile->slop[cell];
#endif
    return better;
}
