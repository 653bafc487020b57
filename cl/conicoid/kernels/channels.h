// From keys and winners to the channels of a tile.

// A depth and the bound of its error, relative to it, into one cell of a plane; the background where nothing is hit.
static inline void write_depth(__global const frame *f, tile_state *tile, int cell, reals depth, reals error, floats *out)
{
    mask hit = tile->winner[cell] != MISS;
    const reals background = (reals)(f->background);
#if EXACT
    // Where neither end of what it may be rounds otherwise, the lower one will do.
    reals low = depth - error * depth, high = depth + error * depth;
    floats written = TO_FLOATS(hit ? low : background);
    note_doubt(tile, cell, hit & may_round_otherwise(written, TO_FLOATS(high)), DOUBT_VALUE);
    out[cell] = written;
#else
    out[cell] = TO_FLOATS(hit ? depth : background);
#endif
}

// P, in binary64 whatever the precision, so that it keeps what t has.
static void store_positions(__global const frame *f, const window *w, tile_state *tile, const reals *t,
                            __global float *planes)
{
    __private const integer *winner = (__private const integer *)tile->winner;
    float out[3][TILE * TILE] ALIGNED;
    for (int pixel = 0; pixel < TILE * TILE; pixel++) {
        double u = w->u0 + pixel % TILE + 0.5, v = w->v0 + pixel / TILE + 0.5;
        double depth = ((__private const real *)t)[pixel], p[3];
#if EXACT
        double error = ((__private const double *)tile->error)[pixel] * depth, largest = 0, lost = 0;
#endif
        for (int j = 0; j < 3; j++) {
            double d = f->rays[3][j] + (f->rays[4][j] * u + f->rays[5][j] * v);
            p[j] = (f->rays[0][j] + (f->rays[1][j] * u + f->rays[2][j] * v)) + depth * d;
#if EXACT
            double size = fabs(f->rays[0][j]) + fabs(f->rays[1][j] * u) + fabs(f->rays[2][j] * v) +
                          depth * (fabs(f->rays[3][j]) + fabs(f->rays[4][j] * u) + fabs(f->rays[5][j] * v));
            largest = fmax(largest, fabs(p[j]));
            lost = fmax(lost, 8 * UNIT_ROUNDOFF * size + error * fabs(d));
#endif
        }
#if EXACT
        // One unit in the last place of the largest component once that is rounded.
        double step = as_float(as_int((float)largest) & 0x7f800000) * 0x1p-23;
        int open = !(largest >= 0x1.1p-100 && largest < 0x1p127) | ((float)(largest - lost) != (float)(largest + lost));
        for (int j = 0; j < 3; j++) {
            double shift = step * 0x1.8p52, rounded = (p[j] + shift) - shift;
            open |= !(fabs(p[j] - rounded) + lost < 0.5 * step);
            p[j] = rounded;
        }
        if (open && winner[pixel] != MISS)
            ((__private integer *)tile->doubt)[pixel] |= DOUBT_POSITION, tile->doubtful = 1;
#endif
        for (int j = 0; j < 3; j++)
            out[j][pixel] = winner[pixel] != MISS ? (float)p[j] + 0.0f : 0.0f;
    }
    for (int j = 0; j < 3; j++)
        store_tile(w, plane_of(f, w, planes, WANT_P) + j * w->plane_size, out[j]);
}

// Z, T, P, A, id: what follows from the depth alone.
static void store_depth_channels(__global const frame *f, const window *w, tile_state *tile, const lists *in,
                                 __global const uint *id, __global float *planes, __global uint *ids)
{
    int channels = f->channels;
    real middle_u = w->u0 + TILE / 2, middle_v = w->v0 + TILE / 2;
    reals t[CELLS];
    floats out[CELLS] ALIGNED;
    // t = unit / key moves by t / unit times what the key does, relative to itself, and a little more.
    const real per_unit = (real)(1.01 / f->unit), unit = (real)f->unit;
    for (int cell = 0; cell < CELLS; cell++) {
        reals key = tile->key[cell];
        t[cell] = (f->orthographic ? -key : 1 / key) * unit;
#if EXACT
        reals error = tile->error[cell];
        tile->error[cell] = (f->orthographic ? error * unit / t[cell] : error * t[cell] * per_unit) + 2 * UNIT_ROUNDOFF;
#endif
        if (channels & WANT_Z)
            write_depth(f, tile, cell, t[cell], tile->error[cell], out);
    }
    if (channels & WANT_Z)
        store_tile(w, plane_of(f, w, planes, WANT_Z), (__private const float *)out);
    if (channels & WANT_ZBACK) {
        for (int cell = 0; cell < CELLS; cell++)
            write_depth(f, tile, cell, tile->last[cell] * unit, tile->last_error[cell] / tile->last[cell], out);
        store_tile(w, plane_of(f, w, planes, WANT_ZBACK), (__private const float *)out);
    }
    if (channels & WANT_T) {
        for (int cell = 0; cell < CELLS; cell++) {
            reals u = in->ramp + ((real)(cell % VECTORS * LANES) + middle_u);
            real v = cell / VECTORS + (real)0.5 - TILE / 2 + middle_v;
            reals x = (real)f->slant[0][0] * u + (real)f->slant[0][1];
            real y = (real)f->slant[1][0] * v + (real)f->slant[1][1];
            reals length = sqrt(x * x + (y * y + 1));
            reals error = (reals)(0);
#if EXACT
            // x and y are sums of two terms that may cancel; their sum of squares and root add four roundings.
            reals slant = 8 * UNIT_ROUNDOFF * (fabs(f->slant[0][1]) + fabs(f->slant[1][1]) + magnitude(x) + fabs(y) + 1);
            error = 1.01 * (tile->error[cell] + slant / length);
#endif
            write_depth(f, tile, cell, t[cell] * length, error, out);
        }
        store_tile(w, plane_of(f, w, planes, WANT_T), (__private const float *)out);
    }
    __private const integer *winner = (__private const integer *)tile->winner;
    __private float *pixel_out = (__private float *)out;
    if (channels & WANT_P)
        store_positions(f, w, tile, t, planes);
    if (channels & WANT_A) {
        for (int cell = 0; cell < CELLS; cell++)
            out[cell] = TO_FLOATS(tile->winner[cell] != MISS ? (reals)(1) : (reals)(0));
        store_tile(w, plane_of(f, w, planes, WANT_A), pixel_out);
    }
    if (channels & WANT_ID) {
        for (int pixel = 0; pixel < TILE * TILE; pixel++)
            pixel_out[pixel] = as_float(winner[pixel] != MISS ? id[in->slots[winner[pixel] >> 2].quadric] : 0u);
        store_tile(w, (__global float *)ids, pixel_out);
    }
}
