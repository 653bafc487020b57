// Every place where a ray can meet a general quadric: both roots of the surface and both caps.

#define ROOT_A 0    // t = q/a, q = -b - sign(b) sqrt(S)
#define ROOT_C 1    // t = c/q
#define CAP_LOW 2
#define CAP_HIGH 3

typedef struct {
    quadratic s, a, c;
    linear b;
    linear range[2], height;    // X3 - z/c at both ends; Y3
    quadratic cap[2];
    int flags, clip_count;
    __global const clip_record *clips;
    double tile_u, tile_v;      // absolute pixels, for the clips
    real near, far;
} general_tile;

typedef struct {
    reals first, last;  // t of the first and last kept hit; first is INFINITY where nothing is kept
    mask kind;          // of the first
} hits;

static inline general_tile move_general(__global const general_record *r, __global const clip_record *clips,
                                        double tile_u, double tile_v, real near, real far)
{
    double du = tile_u - r->centre[0], dv = tile_v - r->centre[1];
    general_tile g;
    g.s = move_quadratic(r->s, du, dv);
    g.a = move_quadratic(r->a, du, dv);
    g.c = move_quadratic(r->c, du, dv);
    g.b = move_linear(r->b, du, dv);
    g.flags = r->flags;
    if (g.flags & (HAS_RANGE | HAS_CAPS)) {
        for (int side = 0; side < 2; side++) {
            g.range[side] = move_linear(r->range[side], du, dv);
            g.cap[side] = move_quadratic(r->cap[side], du, dv);
        }
        g.height = move_linear(r->y[2], du, dv);
    }
    g.clips = clips + r->clip_start;
    g.clip_count = r->clip_count;
    g.tile_u = tile_u;
    g.tile_v = tile_v;
    g.near = near;
    g.far = far;
    return g;
}

// Written so that a NaN is not kept.
static inline mask in_depth(const general_tile *g, reals t)
{
    return (t > 0) & (t < INFINITY) & (t >= g->near) & (t <= g->far);
}

static inline mask in_clips(const general_tile *g, reals t, reals x, real y)
{
    mask kept = (mask)(-1);
    for (int k = 0; k < g->clip_count; k++) {
        linear offset = move_linear(g->clips[k].offset, g->tile_u, g->tile_v);
        linear slope = move_linear(g->clips[k].slope, g->tile_u, g->tile_v);
        kept &= at_linear(offset, x, y) + at_linear(slope, x, y) * t >= 0;
    }
    return kept;
}

static inline void take(hits *h, mask kept, reals t, int kind)
{
    mask nearer = kept & (t < h->first);
    h->first = nearer ? t : h->first;
    h->kind = nearer ? (mask)(kind) : h->kind;
    mask farther = kept & (t > h->last);
    h->last = farther ? t : h->last;
}

static inline hits candidates(const general_tile *g, reals x, real y)
{
    hits h = {(reals)(INFINITY), (reals)(0), (mask)(0)};
    reals s = at_quadratic(g->s, x, y);
    mask real_roots = s >= 0;
    if (g->flags & (ALWAYS_REAL | SINGULAR)) {
        real_roots = (g->flags & ALWAYS_REAL) ? (mask)(-1) : real_roots;
        s = s >= 0 ? s : (reals)(0);
    }
    if (some(real_roots)) {
        reals a = at_quadratic(g->a, x, y);
        reals b = at_linear(g->b, x, y);
        reals c = at_quadratic(g->c, x, y);
        reals root = sqrt(s);
        reals q = b < 0 ? root - b : -(root + b);
        reals ta = q / a, tc = c / q;
        mask ka = real_roots & in_depth(g, ta), kc = real_roots & in_depth(g, tc);
        if (g->flags & HAS_RANGE) {
            reals low = at_linear(g->range[0], x, y), high = at_linear(g->range[1], x, y);
            reals height = at_linear(g->height, x, y);
            ka &= (low + height * ta >= 0) & (high + height * ta <= 0);
            kc &= (low + height * tc >= 0) & (high + height * tc <= 0);
        }
        if (g->clip_count > 0 && some(ka | kc)) {
            ka &= in_clips(g, ta, x, y);
            kc &= in_clips(g, tc, x, y);
        }
        take(&h, ka, ta, ROOT_A);
        take(&h, kc, tc, ROOT_C);
    }
    if (g->flags & HAS_CAPS)
        for (int side = 0; side < 2; side++) {
            mask kept = at_quadratic(g->cap[side], x, y) <= 0;
            if (!some(kept))
                continue;
            reals t = -at_linear(g->range[side], x, y) / at_linear(g->height, x, y);
            kept &= in_depth(g, t);
            if (g->clip_count > 0 && some(kept))
                kept &= in_clips(g, t, x, y);
            take(&h, kept, t, side == 0 ? CAP_LOW : CAP_HIGH);
        }
    return h;
}
