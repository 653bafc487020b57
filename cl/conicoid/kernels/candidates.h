// Every place where a ray can meet a general quadric: both roots of the surface and both caps.

// Kinds of hits. With SHEETS the first two are the first and the second sheet instead.
#define ROOT_C 0    // t = c/q, q = -b - sign(b) sqrt(S): the nearer of two positive roots, as |q| is the larger
#define ROOT_A 1    // t = q/a
#define CAP_LOW 2
#define CAP_HIGH 3

typedef struct {
    reals first, last;  // t of the first and last kept hit; first is INFINITY, last 0, where nothing is kept
    mask kind;          // of the first
#if EXACT
    reals first_error, last_error;  // bounds of their absolute errors
    mask last_kind;
    mask doubt;         // some decision is within its error bound
#endif
} hits;

#if EXACT
// S this many times its error bound is safely a hit: the root's error is then below 1/16 of sqrt(error).
#define CLEAR 64.0
#endif

// With f = k (e + g t)(e' + g' t), `sheet` is k (e g' - e' g), twice a signed root of S: where it has the sign of b,
// q = -k e g' and so q/a = -e/g.
static inline mask first_sheet_is_a(const general_tile *g, reals b, reals x, real y)
{
    return ~((at_linear(g->sheet, x, y) < 0) ^ (b < 0));
}

#if EXACT
// Which of two hits comes first must be clear, from their depths or from where their planes are: tells whether this one
// is before the others, where they tie.
__attribute__((noinline)) static mask before(const general_tile *g, reals x, real y, mask tied, int kind, mask others,
                                             mask nearer, mask *doubt)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (!LANE(integer, tied, lane))
            continue;
        int other = (int)LANE(integer, others, lane);
        int order = nearer_place(g->where, g->where.of[other], g->where.of[kind],
                                 g->tile_u + LANE(real, x, lane), g->tile_v + y);
        LANE(integer, *doubt, lane) |= order == OPEN ? -1 : 0;
        LANE(integer, nearer, lane) = order == NEARER ? -1 : 0;
    }
    return nearer;
}
#endif

static inline void take(hits *h, const general_tile *g, reals x, real y, mask kept, reals t, reals error, int kind)
{
    mask nearer = kept & (t < h->first), farther = kept & (t > h->last);
#if EXACT
    mask tied = kept & (h->first < INFINITY) & (magnitude(t - h->first) <= error + h->first_error);
    mask tied_last = kept & (h->last > 0) & (magnitude(t - h->last) <= error + h->last_error);
    if (some(tied | tied_last)) {
        nearer = before(g, x, y, tied, kind, h->kind, nearer, &h->doubt);
        farther = ~before(g, x, y, tied_last, kind, h->last_kind, ~farther, &h->doubt);
    }
    h->first_error = nearer ? error : h->first_error;
    h->last_error = farther ? error : h->last_error;
    h->last_kind = farther ? (mask)(kind) : h->last_kind;
#endif
    h->first = nearer ? t : h->first;
    h->kind = nearer ? (mask)(kind) : h->kind;
    h->last = farther ? t : h->last;
}

// Whether a cap may be hit where S < 0: f has one sign on such a ray, that of a, and caps are where f <= 0.
static inline int beyond_roots(const general_tile *g) { return (g->flags & (HAS_CAPS | RISING)) == HAS_CAPS; }

// The lanes where a ray can meet the surface or a cap's plane inside its conic.
static inline mask may_meet(const general_tile *g, reals s, reals x, real y)
{
    if (g->flags & ALWAYS_REAL)
        return (mask)(-1);
    int sides = beyond_roots(g) ? 2 : 0;
#if EXACT
    mask met = ~(s < -g->s.error);
    for (int side = 0; side < sides; side++)
        met |= ~(at_quadratic(g->cap[side], x, y) > g->cap[side].error);
#else
    mask met = s >= 0;
    for (int side = 0; side < sides; side++)
        met |= at_quadratic(g->cap[side], x, y) <= 0;
#endif
    return met;
}

// Hits on the lanes of `asked`; any that is certainly beyond `farthest` may be left out. One loop over the four kinds keeps
// the kernel small: PoCL inlines every call.
__attribute__((noinline)) static hits candidates(const general_tile *g, reals s, reals x, real y, mask asked, reals farthest)
{
    hits h;
    h.first = (reals)(INFINITY);
    h.last = (reals)(0);
    h.kind = (mask)(0);
    reals t[4], error[4], a, q;
    mask kept[4] = {(mask)(0), (mask)(0), (mask)(0), (mask)(0)}, doubt = (mask)(0);

    mask real_roots = asked;
    if (!(g->flags & ALWAYS_REAL))
#if EXACT
        real_roots &= ~(s < -g->s.error);
#else
        real_roots &= s >= 0;
#endif
#if EXACT
    h.first_error = h.last_error = (reals)(0);
    h.last_kind = (mask)(0);
    h.doubt = (mask)(0);
    reals q_error;
#endif
    int have_roots = some(real_roots);
    if (have_roots) {
        a = at_quadratic(g->a, x, y);
        reals b = at_linear(g->b, x, y);
        reals c = at_quadratic(g->c, x, y);
        reals root = sqrt(s > 0 ? s : (reals)(0));
        q = b < 0 ? root - b : -(root + b);
        t[ROOT_C] = c / q;
        kept[ROOT_C] = real_roots;
#if EXACT
        reals root_error = g->s.error > 0 ? g->s.error / root : (reals)(0);
        reals size_a = magnitude(a), size_q = magnitude(q);
        q_error = g->b.error + root_error + 4 * UNIT_ROUNDOFF * size_q;
        // First-order terms doubled: they are small wherever the divisors are clear of their errors.
        reals size_tc = magnitude(t[ROOT_C]);
        error[ROOT_C] = 2 * (g->c.error + size_tc * q_error) / size_q + 2 * UNIT_ROUNDOFF * size_tc;
        // Negated, so that numbers out of range, and their bounds, are in doubt too.
        doubt = real_roots & ~((s >= CLEAR * g->s.error) & (size_a >= CLEAR * g->a.error) & (size_q >= CLEAR * q_error));
#endif
    }
    mask left = asked;
    int complete = 0;
    for (int kind = have_roots ? 0 : CAP_LOW; kind < 4; kind++) {
        if (!complete && (kind > 0 || !g->first_only)) {
            complete = 1;
            if (!some(left))
                break;
            if (have_roots) {
                t[ROOT_A] = q / a;
                kept[ROOT_A] = real_roots & left;
#if EXACT
                reals size_a = magnitude(a), size_ta = magnitude(t[ROOT_A]);
                error[ROOT_A] = 2 * (q_error + size_ta * g->a.error) / size_a + 2 * UNIT_ROUNDOFF * size_ta;
                // Where S is known to be zero both roots are one.
                kept[ROOT_A] &= (g->s.error > 0 ? (mask)(-1) : (mask)(s != 0));
                if (g->flags & SHEETS) {
                    mask swapped = first_sheet_is_a(g, at_linear(g->b, x, y), x, y);
                    reals t_c = t[0], error_c = error[0];
                    t[0] = swapped ? t[1] : t_c;
                    t[1] = swapped ? t_c : t[1];
                    error[0] = swapped ? error[1] : error_c;
                    error[1] = swapped ? error_c : error[1];
                    doubt |= real_roots & ~(magnitude(at_linear(g->sheet, x, y)) >= g->sheet.error);
                }
                for (int k = 0; k < 2; k++)
                    if (g->placed & (16 << k))
                        kept[k] = (mask)(0);
#endif
            }
            for (int side = 0; side < (!(g->flags & HAS_CAPS) ? 0 : (g->flags & FLAT) ? 1 : 2); side++) {
                if (g->placed & (16 << (CAP_LOW + side)))
                    continue;
                reals inside = -at_quadratic(g->cap[side], x, y);
                mask in_disc = left & (inside >= 0);
#if EXACT
                mask open = left & ~(magnitude(inside) >= g->cap[side].error);
                in_disc |= open;
#endif
                if (!some(in_disc))
                    continue;
                int cap = CAP_LOW + side;
                reals height = at_linear(g->height, x, y);
                t[cap] = -at_linear(g->range[side], x, y) / height;
                kept[cap] = in_disc;
#if EXACT
                reals size = magnitude(height), size_of_t = magnitude(t[cap]);
                error[cap] = 2 * (g->range[side].error + size_of_t * g->height.error) / size + 2 * UNIT_ROUNDOFF * size_of_t;
                doubt |= open | (in_disc & ~(size >= CLEAR * g->height.error));
#endif
            }
        }
        if (!some(kept[kind]))
            continue;
#if EXACT
        mask beyond = kept[kind] & (t[kind] - error[kind] > farthest);
#else
        mask beyond = kept[kind] & (t[kind] > farthest);
#endif
        kept[kind] = in_depth(g, kind, t[kind], error[kind], kept[kind] & ~beyond, &doubt);
        if (kind < CAP_LOW && (g->flags & HAS_RANGE) && !(g->placed & (1 << kind)) && some(kept[kind]))
            kept[kind] = in_range(g, t[kind], error[kind], x, y, kept[kind], &doubt);
        if (g->clip_count[kind] > 0 && some(kept[kind]))
            kept[kind] = in_clips(g, kind, t[kind], error[kind], x, y, kept[kind], &doubt);
        take(&h, g, x, y, kept[kind], t[kind], error[kind], kind);
        if (kind == ROOT_C && g->first_only) {
            // The other root is farther than a positive one of kind C, or negative. So is what caps close where a > 0 and
            // both are positive, as q then is: f <= 0 is between the roots there.
            mask done = (kept[kind] | beyond) & ~doubt;
            left &= ~((g->flags & HAS_CAPS) ? done & (a > 0) & (q > 0) : done);
        }
    }
#if EXACT
    h.doubt |= doubt;
#endif
    return h;
}
