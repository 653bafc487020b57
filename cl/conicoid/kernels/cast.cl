// One work-item casts one tile: nearest keys first, then depth-only channels, then what needs the winner's form.

#define TILE 16
#define VECTORS (TILE / LANES)          // per row
#define CELLS (TILE * VECTORS)          // per tile
#define MISS ((integer)-1)

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
    double slant[2][2];     // camera ray (u scale, offset), (v scale, offset), for |d|
    double unit;            // kernels' t times this is depth
    double near, far;       // in units
    float background;
    int channels;
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
} tile_state;

// Where keys tie the earlier quadric of the document wins.
static inline mask earlier_at_ties(mask tied, mask winner, int slot, __global const int *document_order)
{
    if (!some(tied))
        return tied;
    for (int lane = 0; lane < LANES; lane++)
        if (LANE(integer, tied, lane) &&
            document_order[slot] > document_order[LANE(integer, winner, lane) >> 2])
            LANE(integer, tied, lane) = 0;
    return tied;
}

static inline int offer(tile_state *tile, int cell, reals key, reals root, mask kind, int slot,
                        __global const int *document_order)
{
    mask better = key > tile->key[cell];
    mask tied = key == tile->key[cell];
    better |= earlier_at_ties(tied & (tile->winner[cell] != MISS), tile->winner[cell], slot, document_order);
    tile->key[cell] = better ? key : tile->key[cell];
    tile->root[cell] = better ? root : tile->root[cell];
    tile->winner[cell] = better ? (kind | (mask)((integer)slot << 2)) : tile->winner[cell];
    return 1;
}

static int cast_simple(tile_state *tile, __global const simple_record *r, int slot, int4 box, int u0, int v0,
                       reals ramp, __global const int *document_order)
{
    const real half_tile = TILE / 2;
    double du = (u0 + TILE / 2) - r->centre[0], dv = (v0 + TILE / 2) - r->centre[1];
    quadratic s = move_quadratic(r->s, du, dv);
    if (highest_quadratic(s, half_tile) * (real)1.0000001 < 0)
        return 0;
    linear b = move_linear(r->b, du, dv);
    int y0 = max(box.y - v0, 0), y1 = min(box.w - v0, TILE);
    int c0 = max(box.x - u0, 0) / LANES, c1 = min((box.z - u0 + LANES - 1) / LANES, VECTORS);
    int improved = 0;
    for (int y = y0; y < y1; y++) {
        real py = y + (real)0.5 - half_tile;
        real s_row = (s.vv * py + s.v) * py + s.one;
        real s_slope = s.uv * py + s.u;
        real b_row = b.v * py + b.one;
        for (int c = c0; c < c1; c++) {
            reals x = ramp + (real)(c * LANES);
            reals at = (s.uu * x + s_slope) * x + s_row;
            if (!some(at >= 0))
                continue;
            reals root = sqrt(at);
            reals key = (b.u * x + b_row) + root;
            int cell = y * VECTORS + c;
            // NaN keys, of negative S, compare false.
            if (some(key >= tile->key[cell]))
                improved |= offer(tile, cell, key, root, (mask)(0), slot, document_order);
        }
    }
    return improved;
}

static int cast_general(tile_state *tile, const general_tile *g, int slot, int4 box, int u0, int v0, reals ramp,
                        int orthographic, __global const int *document_order)
{
    const real half_tile = TILE / 2;
    if (!(g->flags & (HAS_CAPS | ALWAYS_REAL)) && highest_quadratic(g->s, half_tile) * (real)1.0000001 < 0)
        return 0;
    int y0 = max(box.y - v0, 0), y1 = min(box.w - v0, TILE);
    int c0 = max(box.x - u0, 0) / LANES, c1 = min((box.z - u0 + LANES - 1) / LANES, VECTORS);
    int improved = 0;
    for (int y = y0; y < y1; y++)
        for (int c = c0; c < c1; c++) {
            int cell = y * VECTORS + c;
            hits h = candidates(g, ramp + (real)(c * LANES), y + (real)0.5 - half_tile);
            mask hit = h.first < INFINITY;
            if (!some(hit))
                continue;
            reals key = orthographic ? -h.first : 1 / h.first;
            key = hit ? key : (reals)(-INFINITY);
            if (some(hit & (key >= tile->key[cell])))
                improved |= offer(tile, cell, key, (reals)(0), h.kind, slot, document_order);
        }
    return improved;
}

static inline real farthest_key(const tile_state *tile)
{
    reals m = tile->key[0];
    for (int cell = 1; cell < CELLS; cell++)
        m = tile->key[cell] < m ? tile->key[cell] : m;
    return lowest(m);
}

static inline void store_lanes(__global float *plane, int index, floats value, int x, int width)
{
    if (x >= 0 && x + LANES <= width)
        *(__global floats_unaligned *)(plane + index) = value;
    else
        for (int lane = 0; lane < LANES; lane++)
            if (x + lane >= 0 && x + lane < width)
                plane[index + lane] = LANE(float, value, lane);
}

#if REAL_BITS == 64
#define TO_FLOATS(v) JOIN(convert_float, LANES)(v)
#else
#define TO_FLOATS(v) (v)
#endif

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void cast_tiles(__global const frame *f, __global const int *tile_end, __global const int *list,
                __global const int4 *box, __global const double *nearest_key, __global const int *record_of,
                __global const int *document_order, __global const uint *id,
                __global const simple_record *simple, __global const general_record *general,
                __global const clip_record *clips, __global float *planes, __global uint *ids)
{
    int tile_index = get_global_id(1) * f->columns + get_global_id(0);
    int u0 = (f->tile_origin[0] + (int)get_global_id(0)) * TILE, v0 = (f->tile_origin[1] + (int)get_global_id(1)) * TILE;
    int crop_x = f->crop[0], crop_y = f->crop[1];
    int width = f->crop[2] - crop_x, height = f->crop[3] - crop_y;
    long plane_size = (long)width * height;
    int channels = f->channels, orthographic = f->orthographic;
    const real half_tile = TILE / 2;

    tile_state tile;
    real empty = orthographic ? -INFINITY : 0;
    for (int cell = 0; cell < CELLS; cell++) {
        tile.key[cell] = (reals)(empty);
        tile.winner[cell] = (mask)(MISS);
    }
    reals ramp;
    for (int lane = 0; lane < LANES; lane++)
        LANE(real, ramp, lane) = lane + (real)0.5 - half_tile;

    int begin = tile_index == 0 ? 0 : tile_end[tile_index - 1], end = tile_end[tile_index];
    real near = (real)f->near, far = (real)f->far;
    real farthest = empty;
    int stale = 0;
    for (int k = begin; k < end; k++) {
        int slot = list[k];
        if (stale && (k & 7) == 0) {
            farthest = farthest_key(&tile);
            stale = 0;
        }
        // The list is in depth order: nothing behind every pixel can win.
        if ((real)nearest_key[slot] < farthest)
            break;
        int record = record_of[slot];
        if (record >= 0) {
            stale |= cast_simple(&tile, simple + record, slot, box[slot], u0, v0, ramp, document_order);
        } else {
            general_tile g = move_general(general + ~record, clips, u0 + TILE / 2, v0 + TILE / 2, near, far);
            stale |= cast_general(&tile, &g, slot, box[slot], u0, v0, ramp, orthographic, document_order);
        }
    }

    __global float *plane = planes;
    __global float *out_z = plane;
    plane += (channels & WANT_Z) ? plane_size : 0;
    __global float *out_t = plane;
    plane += (channels & WANT_T) ? plane_size : 0;
    __global float *out_back = plane;
    plane += (channels & WANT_ZBACK) ? plane_size : 0;
    __global float *out_n = plane;
    plane += (channels & WANT_N) ? 3 * plane_size : 0;
    __global float *out_p = plane;
    plane += (channels & WANT_P) ? 3 * plane_size : 0;
    __global float *out_a = plane;
    int y_begin = max(crop_y - v0, 0), y_end = min(f->crop[3] - v0, TILE);
    floats background = (floats)(f->background);

    for (int y = y_begin; y < y_end; y++)
        for (int c = 0; c < VECTORS; c++) {
            int cell = y * VECTORS + c;
            int x = u0 + c * LANES - crop_x;
            if (x + LANES <= 0 || x >= width)
                continue;
            long index = (long)(v0 + y - crop_y) * width + x;
            mask hit = tile.winner[cell] != MISS;
            int any_hit = some(hit);
            reals t = (orthographic ? -tile.key[cell] : 1 / tile.key[cell]) * (real)f->unit;
            reals px = ramp + (real)(c * LANES);
            real py = y + (real)0.5 - half_tile;
            if (channels & WANT_Z) {
                floats z = any_hit ? TO_FLOATS(hit ? t : (reals)(f->background)) : background;
                store_lanes(out_z, index, z, x, width);
            }
            if (channels & WANT_T) {
                reals sx = (real)f->slant[0][0] * (px + (real)(u0 + TILE / 2)) + (real)f->slant[0][1];
                real sy = (real)f->slant[1][0] * (py + (real)(v0 + TILE / 2)) + (real)f->slant[1][1];
                reals distance = t * sqrt(sx * sx + sy * sy + 1);
                store_lanes(out_t, index, TO_FLOATS(hit ? distance : (reals)(f->background)), x, width);
            }
            if (channels & WANT_P)
                for (int j = 0; j < 3; j++)
                    for (int lane = 0; lane < LANES; lane++) {
                        if (x + lane < 0 || x + lane >= width)
                            continue;
                        // Always binary64: the position keeps what t has.
                        double u = u0 + c * LANES + lane + 0.5, v = v0 + y + 0.5;
                        double depth = LANE(real, t, lane);
                        double p = f->rays[0][j] + (f->rays[1][j] * u + f->rays[2][j] * v);
                        double d = f->rays[3][j] + (f->rays[4][j] * u + f->rays[5][j] * v);
                        out_p[j * plane_size + index + lane] = LANE(integer, hit, lane) ? (float)(p + depth * d) : 0.0f;
                    }
            if (channels & WANT_ID)
                for (int lane = 0; lane < LANES; lane++)
                    if (x + lane >= 0 && x + lane < width)
                        ids[index + lane] = LANE(integer, hit, lane) ? id[LANE(integer, tile.winner[cell], lane) >> 2] : 0;
            if (channels & WANT_A)
                store_lanes(out_a, index, TO_FLOATS(hit ? (reals)(1) : (reals)(0)), x, width);
        }

    if (!(channels & (WANT_N | WANT_ZBACK)))
        return;
    floats normal[3][CELLS], back[CELLS];
    for (int cell = 0; cell < CELLS; cell++) {
        normal[0][cell] = normal[1][cell] = normal[2][cell] = (floats)(0.0f);
        back[cell] = background;
    }
    mask left[CELLS];
    for (int cell = 0; cell < CELLS; cell++)
        left[cell] = tile.winner[cell] >> 2;
    for (int pixel = 0; pixel < CELLS * LANES; pixel++) {
        integer slot = ((__private integer *)left)[pixel];
        if (slot < 0)
            continue;
        int record = record_of[slot];
        simple_normal sn;
        general_tile g;
        general_normal gn;
        if (record >= 0) {
            __global const simple_record *r = simple + record;
            sn = move_simple_normal(r, (u0 + TILE / 2) - r->centre[0], (v0 + TILE / 2) - r->centre[1]);
        } else {
            __global const general_record *r = general + ~record;
            g = move_general(r, clips, u0 + TILE / 2, v0 + TILE / 2, near, far);
            gn = move_general_normal(r, (u0 + TILE / 2) - r->centre[0], (v0 + TILE / 2) - r->centre[1]);
        }
        for (int cell = pixel / LANES; cell < CELLS; cell++) {
            mask mine = left[cell] == (mask)(slot);
            if (!some(mine))
                continue;
            left[cell] = mine ? (mask)(MISS) : left[cell];
            reals px = ramp + (real)(cell % VECTORS * LANES);
            real py = cell / VECTORS + (real)0.5 - half_tile;
            if (channels & WANT_N) {
                vector3 n;
                if (record >= 0)
                    n = simple_normal_at(&sn, tile.root[cell], px, py);
                else
                    n = general_normal_at(&g, &gn, tile.winner[cell] & 3, f->outward, px, py);
                reals square = n.x * n.x + n.y * n.y + n.z * n.z;
                mask vanishes = mine & ~(square > 0);
                if (some(vanishes)) {
                    reals u = px + (real)(u0 + TILE / 2);
                    real v = py + (v0 + TILE / 2);
                    n.x = vanishes ? (real)f->back[0][0] * u + ((real)f->back[0][1] * v + (real)f->back[0][2]) : n.x;
                    n.y = vanishes ? (real)f->back[1][0] * u + ((real)f->back[1][1] * v + (real)f->back[1][2]) : n.y;
                    n.z = vanishes ? (real)f->back[2][0] * u + ((real)f->back[2][1] * v + (real)f->back[2][2]) : n.z;
                    square = n.x * n.x + n.y * n.y + n.z * n.z;
                }
                reals scale = 1 / sqrt(square);
                // Adding +0 turns -0 into +0 and changes nothing else.
                normal[0][cell] = TO_FLOATS(mine ? n.x * scale : (reals)(0)) + normal[0][cell];
                normal[1][cell] = TO_FLOATS(mine ? n.y * scale : (reals)(0)) + normal[1][cell];
                normal[2][cell] = TO_FLOATS(mine ? n.z * scale : (reals)(0)) + normal[2][cell];
            }
            if (channels & WANT_ZBACK) {
                reals last = candidates(&g, px, py).last * (real)f->unit;
                floats previous = back[cell];
                floats z = TO_FLOATS(last);
                for (int lane = 0; lane < LANES; lane++)
                    if (LANE(integer, mine, lane))
                        LANE(float, previous, lane) = LANE(float, z, lane);
                back[cell] = previous;
            }
        }
    }
    for (int y = y_begin; y < y_end; y++)
        for (int c = 0; c < VECTORS; c++) {
            int cell = y * VECTORS + c;
            int x = u0 + c * LANES - crop_x;
            if (x + LANES <= 0 || x >= width)
                continue;
            long index = (long)(v0 + y - crop_y) * width + x;
            if (channels & WANT_N)
                for (int j = 0; j < 3; j++)
                    store_lanes(out_n + j * plane_size, index, normal[j][cell], x, width);
            if (channels & WANT_ZBACK)
                store_lanes(out_back, index, back[cell], x, width);
        }
}
