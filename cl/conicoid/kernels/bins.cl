// The lists of quadrics that each tile must look at, in depth order. Boxes are in tiles, half-open (x0, y0, x1, y1).

// `next` holds the first free place of each tile's list, and its end afterwards.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void fill_tiles(int boxes, __global const int4 *box, int columns, __global int *next, __global int *list)
{
    int row = get_global_id(0);
    for (int i = 0; i < boxes; i++) {
        int4 b = box[i];
        if (b.y <= row && row < b.w)
            for (int x = b.x; x < b.z; x++)
                list[next[row * columns + x]++] = i;
    }
}
