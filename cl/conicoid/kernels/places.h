// Which of two surfaces that tie is the nearer, as exact arithmetic has told beforehand.

#if EXACT
#define FARTHER 0
#define NEARER 1
#define SAME 2  // one set of points
#define OPEN 3

typedef struct {
    __global const int *of;                 // by 4 x slot + kind of hit: the row of `known`, -1 where nothing is known
    __global const plane_record *known;
} places;

static inline double lead_at(__global const plane_record *p, double u, double v, double *size)
{
    double along = p->lead[0] * u, down = p->lead[1] * v;
    *size += fabs(along) + fabs(down) + fabs(p->lead[2]);
    return along + down + p->lead[2];
}

// How `next` lies to `other` on the ray of (u, v).
static inline int nearer_place(places where, int other, int next, double u, double v)
{
    if (other < 0 || next < 0)
        return OPEN;
    if (other == next)
        return SAME;
    __global const plane_record *p = where.known + other, *q = where.known + next;
    if (p->cluster < 0 || p->cluster != q->cluster)
        return OPEN;
    double size = 0;
    double lead = lead_at(q, u, v, &size) - lead_at(p, u, v, &size);
    // Five roundings: storing, one product, two sums, the difference.
    if (!(fabs(lead) > 8 * UNIT_ROUNDOFF * size))
        return OPEN;
    return lead > 0 ? NEARER : FARTHER;
}
#endif
