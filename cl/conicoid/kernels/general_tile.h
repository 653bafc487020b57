// A general record moved to a tile.

// Half-spaces that are moved to a tile once, not for every vector.
#define MOST_MOVED 8

typedef struct {
    quadratic s, a, c;
    linear b;
    linear range[2], height;    // X3 - z/c at both ends; Y3
    quadratic cap[2];
    linear sheet;
    int flags, placed;
    int first_only;             // of the hits on a ray
    __global const int *clip_start, *clip_count;    // by kind
    __global const clip_record *clips;
    linear offset[MOST_MOVED], slope[MOST_MOVED];   // of the clips from `first_moved` on
    int first_moved, moved;
    double tile_u, tile_v;      // absolute pixels, for the other clips
    real near, far;
#if EXACT
    places where;
#endif
} general_tile;

#if EXACT
// What set-up lost in double-double, in the sizes that its terms had before they cancelled.
static void add_setup_noise(general_tile *g, __global const general_record *r, double du, double dv)
{
    double moving = norm_at(r->moving_norm, du, dv);
    double x = (g->flags & ORTHOGRAPHIC) ? moving : r->fixed_norm;
    double y = (g->flags & ORTHOGRAPHIC) ? r->fixed_norm : moving;
    // Every double-double is within 2^-98 kappa of its size, a Pluecker coordinate within twice that of x y; products
    // of two such then differ by 2 l d + d^2. The last doubling is for what a dozen more operations add.
    double unit = 0x1p-95 * r->kappa;
    double l = norm_at(r->moment_norm, du, dv), d = unit * x * y;
    g->s.error += r->compound_sum * ((2.0 * l + d) * d + 0x1p-95 * l * l);
    g->a.error += unit * r->spatial_sum * y * y;
    g->b.error += unit * r->form_sum * x * y;
    g->c.error += unit * r->form_sum * x * x;
    if (!(g->flags & HAS_RANGE))
        return;
    for (int side = 0; side < 2; side++) {
        double end = r->end[side];
        g->range[side].error += unit * (x + end);
        double e = l * (1.0 + end), de = d * (1.0 + end);
        g->cap[side].error += r->form_sum * ((2.0 * e + de) * de + 0x1p-95 * e * e);
    }
    g->height.error += unit * y;
}
#endif

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
    if (g.flags & HAS_RANGE) {
        for (int side = 0; side < 2; side++) {
            g.range[side] = move_linear(r->range[side], du, dv);
            g.cap[side] = move_quadratic(r->cap[side], du, dv);
        }
        g.height = move_linear(r->y[2], du, dv);
    }
    if (g.flags & SHEETS)
        g.sheet = move_linear(r->sheet, du, dv);
    g.placed = r->placed;
    g.first_only = 0;
    g.clip_start = r->clip_start;
    g.clip_count = r->clip_count;
    g.clips = clips;
    g.moved = 0;
    g.tile_u = tile_u;
    g.tile_v = tile_v;
    g.near = near;
    g.far = far;
#if EXACT
    add_setup_noise(&g, r, du, dv);
#endif
    return g;
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
