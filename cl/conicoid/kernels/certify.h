// Error bounds of EXACT casting that are not part of a polynomial, and the list of pixels that they leave open.

#if EXACT
// Error bounds of a simple record over a tile; that of S counts twice, as casting adds it to S. No term of S, expanded in the parameter-space moments, passes through
// more than 30 roundings (set-up 14, moving 7, evaluation 6, two divisions by a rounded F'DF), none of b through more
// than 20.
typedef struct {
    real s, b;
} simple_error;

static inline simple_error simple_error_of(__global const simple_record *r, double du, double dv)
{
    double s = norm_at(r->s_norm, du, dv);
    return (simple_error){80.0 * UNIT_ROUNDOFF * s * s, 24.0 * UNIT_ROUNDOFF * norm_at(r->b_norm, du, dv)};
}

// Whether a value within `error` of x may round to another binary32 than x does: the nearest boundary between two
// binary32 numbers is half a unit in the last place from the rounded one. Beyond binary32 the rounded one is infinite,
// and below its normal range boundaries are farther than is assumed here: both err towards doubt.
static inline mask may_round_otherwise(reals x, reals error)
{
    reals rounded = FROM_FLOATS(TO_FLOATS(x));
    reals half_ulp = JOIN(as_double, LANES)(JOIN(as_long, LANES)(x) & 0x7ff0000000000000L) * 0x1p-24;
    return ~(half_ulp - magnitude(x - rounded) > error);
}

// A unit normal is wrong by less than 4 e / |n| where each component of n is wrong by at most e; a quarter of the
// promised 2^-23 is left to it, the rest to rounding. |n| is near 1: records and general_normal_at see to that.
static inline mask loose_normal(reals e, reals square) { return ~(e * e * 0x1p4 <= square * 0x1p-50); }

static inline void note_doubt(tile_state *tile, int cell, mask lanes, int reason)
{
    tile->doubt[cell] |= lanes & reason;
    tile->any_doubt |= lanes;
}

static void list_doubts(__global const frame *f, const window *w, const tile_state *tile, __global int *count,
                        __global doubtful_pixel *doubts)
{
    if (!some(tile->any_doubt))
        return;
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
