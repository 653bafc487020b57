// The lists of quadrics that each tile must look at, in depth order: a stable counting sort by tile, in parts of the order
// that are counted and filled side by side. `box` are pixel boxes in depth order, [x0, x1) x [y0, y1).

static inline int4 tiles_of(int4 box, int2 origin)
{
    return (int4)(box.x / TILE - origin.x, box.y / TILE - origin.y, (box.z + TILE - 1) / TILE - origin.x,
                  (box.w + TILE - 1) / TILE - origin.y);
}

// How many boxes of each part touch each tile: counts[part][tile], zero before.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void count_tiles(int count, int parts, __global const int4 *box, int2 origin, int2 grid, __global int *counts)
{
    int part = get_global_id(0);
    int first = (long)count * part / parts, last = (long)count * (part + 1) / parts;
    __global int *own = counts + (long)part * grid.x * grid.y;
    for (int slot = first; slot < last; slot++) {
        int4 t = tiles_of(box[slot], origin);
        for (int y = t.y; y < t.w; y++)
            for (int x = t.x; x < t.z; x++)
                own[y * grid.x + x]++;
    }
}

// next[part][tile]: the first free place of the part in the tile's list.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void fill_tiles(int count, int parts, __global const int4 *box, int2 origin, int2 grid, __global int *next,
                __global int *list)
{
    int part = get_global_id(0);
    int first = (long)count * part / parts, last = (long)count * (part + 1) / parts;
    __global int *own = next + (long)part * grid.x * grid.y;
    for (int slot = first; slot < last; slot++) {
        int4 t = tiles_of(box[slot], origin);
        for (int y = t.y; y < t.w; y++)
            for (int x = t.x; x < t.z; x++)
                list[own[y * grid.x + x]++] = slot;
    }
}
