// The lists of quadrics that each tile must look at, in depth order.

// One row of tiles per work-item. `boxes` are half-open ranges of columns, those of row r in depth order from
// row_start[r] to row_start[r + 1]; `next` holds the first free place of each tile's list.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void fill_tiles(__global const int *row_start, __global const int *slots, __global const int4 *box, int columns,
                __global int *next, __global int *list)
{
    int row = get_global_id(0);
    __global int *place = next + row * columns;
    for (int i = row_start[row]; i < row_start[row + 1]; i++) {
        int slot = slots[i];
        int4 b = box[slot];
        for (int x = b.x; x < b.z; x++)
            list[place[x]++] = slot;
    }
}
