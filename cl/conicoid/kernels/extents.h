// What of a general quadric its range, its clips, near and far leave: of a tile, of a row, of the points of a ray.

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
        low = s->low[k] - along > low ? s->low[k] - along : low;
        high = s->high[k] - along < high ? s->high[k] - along : high;
    }
    if (low > high) {
        *c1 = 0;
        return;
    }
    *c0 = max(*c0, (int)(low + first) / LANES);
    *c1 = min(*c1, (int)(high + first) / LANES + 1);
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
    real end = -most / steepest;
    if (steepest > 0)
        s.low = most < 0 && end > s.low ? end : s.low;
    else if (most < 0)
        s.high = -1;
    else if (steepest < 0)
        s.high = end < s.high ? end : s.high;
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

// Keeps the lanes of `kept` where value >= 0 (NaN drops), and notes those that the error leaves open.
#if EXACT
#define KEEP(kept, doubt, value, error)                   \
    do {                                                  \
        doubt |= kept & ~(magnitude(value) >= (error));   \
        kept &= (value) >= 0;                             \
    } while (0)
#else
#define KEEP(kept, doubt, value, error) kept &= (value) >= 0
#endif

static inline mask in_depth(const general_tile *g, int kind, reals t, reals error, mask kept, mask *doubt)
{
    // A root beyond all numbers is none; written so that a NaN is not kept.
    kept &= magnitude(t) < INFINITY;
    KEEP(kept, *doubt, t, 2 * error);
    kept &= t > 0;
    if (g->placed & (1 << kind))
        return kept;
    if (g->near > 0)
        KEEP(kept, *doubt, t - g->near, error + 2 * (real)UNIT_ROUNDOFF * g->near);
    if (g->far < INFINITY)
        KEEP(kept, *doubt, g->far - t, error + 2 * (real)UNIT_ROUNDOFF * g->far);
    return kept;
}

static inline mask in_clips(const general_tile *g, int kind, reals t, reals error, reals x, real y, mask kept,
                            mask *doubt)
{
    for (int k = g->clip_start[kind]; k < g->clip_start[kind] + g->clip_count[kind]; k++) {
        int at = k - g->first_moved, ready = at >= 0 && at < g->moved;
        linear offset = ready ? g->offset[at] : move_linear(g->clips[k].offset, g->tile_u, g->tile_v);
        linear slope = ready ? g->slope[at] : move_linear(g->clips[k].slope, g->tile_u, g->tile_v);
        reals along = at_linear(slope, x, y);
        reals value = at_linear(offset, x, y) + along * t;
        KEEP(kept, *doubt, value,
             offset.error + t * slope.error + magnitude(along) * error + CHAIN * (offset.error * (1 / CHAIN) + magnitude(along * t)));
    }
    return kept;
}

static inline mask in_range(const general_tile *g, reals t, reals error, reals x, real y, mask kept, mask *doubt)
{
    reals height = at_linear(g->height, x, y);
    reals rise = height * t;
    for (int side = 0; side < 2; side++) {
        reals offset = at_linear(g->range[side], x, y);
        reals value = side == 0 ? offset + rise : -(offset + rise);
        KEEP(kept, *doubt, value,
             g->range[side].error + t * g->height.error + magnitude(height) * error + CHAIN * (magnitude(offset) + magnitude(rise)));
    }
    return kept;
}
