// What EXACT casting certifies of the values it writes, and the list of the pixels that it leaves open.

#if EXACT
// N is rounded to multiples of this, P to units in the last place of its largest component: small components are as
// coarse as large ones, so that a zero is never hard to round.
#define NORMAL_STEP 0x1p-23
// Where a value between two that round to `low` and `high` may round to another number. Numbers below binary32's normal
// range, which devices may flush to zero, are left open, and so are NaNs.
static inline mask may_round_otherwise(floats low, floats high)
{
    return __builtin_convertvector(~((low == high) & (low >= 0x1p-126f)), mask);
}

// A component times the scale, to the nearest multiple of NORMAL_STEP: of one unit in the last place of the sum. Never -0.
static inline reals nearest_step(reals component, reals scale)
{
    const reals shift = (reals)(NORMAL_STEP * 0x1.8p52);
    return (component * scale + shift) - shift;
}

static inline void note_doubt(tile_state *tile, int cell, mask lanes, int reason)
{
    // Seldom: nothing waits for memory.
    if (some(lanes)) {
        tile->doubt[cell] |= lanes & reason;
        tile->doubtful = 1;
    }
}

static void list_doubts(__global const frame *f, const window *w, const tile_state *tile, __global int *count,
                        __global doubtful_pixel *doubts)
{
    for (int cell = 0; cell < CELLS; cell++) {
        if (!some(tile->doubt[cell]))
            continue;
        for (int lane = 0; lane < LANES; lane++) {
            integer doubt = LANE(const integer, tile->doubt[cell], lane);
            int reasons = (int)(doubt & 0xff);
            int winner = (int)LANE(const integer, tile->winner[cell], lane);
            int x = cell % VECTORS * LANES + lane, y = cell / VECTORS;
            if (winner == MISS)
                reasons &= DOUBT_HIT;
            if (!reasons || x < w->x0 || x >= w->x1 || y < w->y0 || y >= w->y1)
                continue;
            double key = LANE(const real, tile->key[cell], lane);
            double depth = winner == MISS ? 0.0 : (f->orthographic ? -key : 1 / key) * f->unit;
            int place = atomic_inc(count);
            if (place < f->capacity)
                doubts[place] = (doubtful_pixel){depth, w->u0 + x, w->v0 + y, winner,
                                                 (int)(doubt >> 32) - 1, reasons};
        }
    }
}
#endif
