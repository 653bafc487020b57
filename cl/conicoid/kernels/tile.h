// A tile of the image, what is known of its pixels, and the way out to the planes.

#define WANT_Z 1
#define WANT_T 2
#define WANT_ZBACK 4
#define WANT_N 8
#define WANT_P 16
#define WANT_ID 32
#define WANT_A 64

// One frame's constants; cast.py fills the same fields in the same order.
typedef struct {
    double rays[6][3];      // point 1, u, v, direction 1, u, v, world axes, directions not scaled
    double back[3][3];      // towards the eye in target space: x, y, z each u, v, 1
    double axes[3][3];      // less the gradients of u, v (both times depth, about the principal point) and depth, target space
    double principal[2];
    double slant[2][2];     // camera ray (u scale, offset), (v scale, offset), for |d|
    double unit;            // kernels' t times this is depth
    double near, far;       // in units
    float background;
    int channels;
    int capacity;           // of the list of doubtful pixels
    int orthographic;
    int outward;
    int crop[4];
    int tile_origin[2];     // first tile's column and row
    int columns;
} frame;

typedef struct {
    reals key[CELLS];       // 1/t (pinhole) or -t (orthographic): larger is nearer
    reals root[CELLS];      // sqrt(S) of simple winners
    mask winner[CELLS];     // 4 x slot + kind, or MISS
    reals last[CELLS];      // t of the winner's last hit, where ZBack is asked
    // Bounds of errors, which EXACT casting knows.
    reals error[CELLS];     // of the winner's key, then of its t, relative to it
    reals last_error[CELLS];
#if EXACT
    reals bar[CELLS];       // the key less what it may be too large
    int doubtful;           // whether any cell has a doubt
    mask doubt[CELLS];      // reasons below; in the upper half 1 + (4 x slot + kind) of a hit that ties the winner
#endif
} tile_state;

// A pixel that binary64 cannot settle.
typedef struct {
    double depth;           // of the winner, 0 where there is none
    int x, y;               // in the whole image
    int winner, rival;      // as in tile_state, -1 where there is none
    int reasons;
} doubtful_pixel;

#define DOUBT_HIT 1         // what is hit
#define DOUBT_VALUE 2       // how a depth rounds
#define DOUBT_NORMAL 4      // the normal, which is too near a tangent ray or a vanishing gradient
#define DOUBT_POSITION 8

// Where a tile lies in the crop.
typedef struct {
    int u0, v0;         // first pixel in the whole image
    int x, y;           // the same in the crop; negative where the crop starts inside the tile
    int width;          // of the crop
    int x0, x1, y0, y1; // the tile's columns and rows inside the crop
    long plane_size;
} window;

static inline window window_of(__global const frame *f, int u0, int v0)
{
    window w;
    w.u0 = u0;
    w.v0 = v0;
    w.x = u0 - f->crop[0];
    w.y = v0 - f->crop[1];
    w.width = f->crop[2] - f->crop[0];
    w.x0 = max(-w.x, 0);
    w.x1 = min(f->crop[2] - u0, TILE);
    w.y0 = max(-w.y, 0);
    w.y1 = min(f->crop[3] - v0, TILE);
    w.plane_size = (long)w.width * (f->crop[3] - f->crop[1]);
    return w;
}

// Whole, aligned rows are streamed past the cache, which saves reading them first.
__attribute__((noinline)) static void store_tile(const window *w, __global float *plane, __private const float *values)
{
    __global float *row = plane + (long)w->y * w->width + w->x;
    if (w->x0 == 0 && w->x1 == TILE && ((ulong)row & 63) == 0 && (w->width & 15) == 0) {
        for (int y = w->y0; y < w->y1; y++)
            for (int k = 0; k < TILE / 8; k++)
                __builtin_nontemporal_store(((__private const float8 *)values)[y * (TILE / 8) + k],
                                            (__global float8 *)(row + (long)y * w->width) + k);
    } else {
        for (int y = w->y0; y < w->y1; y++)
            for (int x = w->x0; x < w->x1; x++)
                row[(long)y * w->width + x] = values[y * TILE + x];
    }
}

static inline void fill_tile(const window *w, __global float *plane, float value)
{
    float8 row[TILE * TILE / 8];
    for (int k = 0; k < TILE * TILE / 8; k++)
        row[k] = (float8)(value);
    store_tile(w, plane, (__private const float *)row);
}

// The planes that are asked for lie one after the other: Z, T, ZBack, N, P, A.
static inline __global float *plane_of(__global const frame *f, const window *w, __global float *planes, int channel)
{
    const int order[6] = {WANT_Z, WANT_T, WANT_ZBACK, WANT_N, WANT_P, WANT_A}, count[6] = {1, 1, 1, 3, 3, 1};
    for (int c = 0; order[c] != channel; c++)
        if (f->channels & order[c])
            planes += count[c] * w->plane_size;
    return planes;
}

static inline void store_background(__global const frame *f, const window *w, __global float *planes, __global uint *ids)
{
    const int channel[6] = {WANT_Z, WANT_T, WANT_ZBACK, WANT_N, WANT_P, WANT_A}, count[6] = {1, 1, 1, 3, 3, 1};
    for (int c = 0; c < 6; c++)
        for (int k = 0; (f->channels & channel[c]) && k < count[c]; k++) {
            fill_tile(w, planes, c < 3 ? f->background : 0.0f);
            planes += w->plane_size;
        }
    if (f->channels & WANT_ID)
        fill_tile(w, (__global float *)ids, 0.0f);
}
