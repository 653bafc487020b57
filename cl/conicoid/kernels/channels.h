// From keys and winners to the channels of a tile.

// Z, T, P, A, id: what follows from the depth alone.
static void store_depth_channels(__global const frame *f, const window *w, tile_state *tile, reals ramp,
                                 __global const uint *id, __global float *planes, __global uint *ids)
{
    int channels = f->channels;
    real middle_u = w->u0 + TILE / 2, middle_v = w->v0 + TILE / 2;
    reals t[CELLS];
    for (int cell = 0; cell < CELLS; cell++) {
        reals key = tile->key[cell];
        t[cell] = (f->orthographic ? -key : 1 / key) * (real)f->unit;
    }
    floats out[CELLS] ALIGNED;
#if EXACT
    reals error[CELLS];
    const double per_unit = 1.01 / f->unit;
#endif
    for (int cell = 0; cell < CELLS; cell++) {
        mask hit = tile->winner[cell] != MISS;
#if EXACT
        // t = unit / key moves by t^2 / unit times what the key does.
        reals moved = f->orthographic ? tile->slop[cell] * f->unit : tile->slop[cell] * (t[cell] * t[cell]) * per_unit;
        error[cell] = moved + 2 * UNIT_ROUNDOFF * t[cell];
        if (channels & WANT_Z)
            note_doubt(tile, cell, hit & may_round_otherwise(t[cell], error[cell]), DOUBT_VALUE);
#endif
        out[cell] = TO_FLOATS(hit ? t[cell] : (reals)(f->background));
    }
    if (channels & WANT_Z)
        store_tile(w, plane_of(f, w, planes, WANT_Z), (__private const float *)out);
    if (channels & WANT_ZBACK) {
        for (int cell = 0; cell < CELLS; cell++) {
            reals last = tile->last[cell] * (real)f->unit;
            mask hit = tile->winner[cell] != MISS;
            out[cell] = TO_FLOATS(hit ? last : (reals)(f->background));
#if EXACT
            note_doubt(tile, cell, hit & may_round_otherwise(last, tile->last_error[cell] * f->unit), DOUBT_VALUE);
#endif
        }
        store_tile(w, plane_of(f, w, planes, WANT_ZBACK), (__private const float *)out);
    }
    if (channels & WANT_T) {
        for (int cell = 0; cell < CELLS; cell++) {
            reals u = ramp + ((real)(cell % VECTORS * LANES) + middle_u);
            real v = cell / VECTORS + (real)0.5 - TILE / 2 + middle_v;
            reals x = (real)f->slant[0][0] * u + (real)f->slant[0][1];
            real y = (real)f->slant[1][0] * v + (real)f->slant[1][1];
            reals length = sqrt(x * x + (y * y + 1));
            reals distance = t[cell] * length;
#if EXACT
            // x and y are sums of two terms that may cancel; their sum of squares and root add four roundings.
            reals slant = 8 * UNIT_ROUNDOFF * (fabs(f->slant[0][1]) + fabs(f->slant[1][1]) + magnitude(x) + fabs(y) + 1);
            mask open = may_round_otherwise(distance, error[cell] * length + t[cell] * slant);
            note_doubt(tile, cell, (tile->winner[cell] != MISS) & open, DOUBT_VALUE);
#endif
            out[cell] = TO_FLOATS(tile->winner[cell] != MISS ? distance : (reals)(f->background));
        }
        store_tile(w, plane_of(f, w, planes, WANT_T), (__private const float *)out);
    }
    __private const integer *winner = (__private const integer *)tile->winner;
    __private float *pixel_out = (__private float *)out;
#if EXACT
    if (channels & WANT_P)
        for (int pixel = 0; pixel < TILE * TILE; pixel++) {
            double u = w->u0 + pixel % TILE + 0.5, v = w->v0 + pixel / TILE + 0.5;
            double depth = ((__private const double *)t)[pixel], largest = 0, lost = 0;
            for (int j = 0; j < 3; j++) {
                double d = f->rays[3][j] + (f->rays[4][j] * u + f->rays[5][j] * v);
                double p = f->rays[0][j] + (f->rays[1][j] * u + f->rays[2][j] * v);
                double size = fabs(f->rays[0][j]) + fabs(f->rays[1][j] * u) + fabs(f->rays[2][j] * v) +
                              depth * (fabs(f->rays[3][j]) + fabs(f->rays[4][j] * u) + fabs(f->rays[5][j] * v));
                largest = fmax(largest, fabs(p + depth * d));
                lost = fmax(lost, 8 * UNIT_ROUNDOFF * size + ((__private const double *)error)[pixel] * fabs(d));
            }
            // Half a unit in the last place of the largest component is at least 2^-25 of it.
            if (!(lost <= 0x1p-25 * largest) || !(largest < 0x1p127))
                ((__private integer *)tile->doubt)[pixel] |= DOUBT_POSITION, tile->any_doubt = (mask)(-1);
        }
#endif
    if (channels & WANT_P)
        for (int j = 0; j < 3; j++) {
            // In binary64 whatever the precision: the position keeps what t has.
            for (int pixel = 0; pixel < TILE * TILE; pixel++) {
                double u = w->u0 + pixel % TILE + 0.5, v = w->v0 + pixel / TILE + 0.5;
                double p = f->rays[0][j] + (f->rays[1][j] * u + f->rays[2][j] * v);
                double d = f->rays[3][j] + (f->rays[4][j] * u + f->rays[5][j] * v);
                double depth = ((__private const real *)t)[pixel];
                pixel_out[pixel] = winner[pixel] != MISS ? (float)(p + depth * d) + 0.0f : 0.0f;
            }
            store_tile(w, plane_of(f, w, planes, WANT_P) + j * w->plane_size, pixel_out);
        }
    if (channels & WANT_A) {
        for (int cell = 0; cell < CELLS; cell++)
            out[cell] = TO_FLOATS(tile->winner[cell] != MISS ? (reals)(1) : (reals)(0));
        store_tile(w, plane_of(f, w, planes, WANT_A), pixel_out);
    }
    if (channels & WANT_ID) {
        for (int pixel = 0; pixel < TILE * TILE; pixel++)
            pixel_out[pixel] = as_float(winner[pixel] != MISS ? id[winner[pixel] >> 2] : 0u);
        store_tile(w, (__global float *)ids, pixel_out);
    }
}

// 1/sqrt(square): a binary32 start and one Newton step, relative error below 2^-44; half the cost of sqrt and divide.
// Only for squares well inside binary32's range.
static inline reals inverse_length(reals square)
{
#if REAL_BITS == 64
    if (!some((square < 0x1p-100) | (square > 0x1p100))) {
        reals r = FROM_FLOATS(1 / sqrt(TO_FLOATS(square)));
        return r * (1.5 - (0.5 * square) * (r * r));
    }
#endif
    return 1 / sqrt(square);
}

// N: winner by winner, so that a form is moved to the tile once.
static void store_form_channels(__global const frame *f, const window *w, tile_state *tile, reals ramp,
                                __global const int *record_of, __global const simple_record *simple,
                                __global const general_record *general, __global const clip_record *clips,
                                real near, real far, __global float *planes)
{
    int channels = f->channels;
    int middle_u = w->u0 + TILE / 2, middle_v = w->v0 + TILE / 2;
    floats normal[3][CELLS] ALIGNED;
    mask left[CELLS];
    for (int cell = 0; cell < CELLS; cell++) {
        normal[0][cell] = normal[1][cell] = normal[2][cell] = (floats)(0.0f);
        left[cell] = tile->winner[cell] >> 2;
    }
    for (int start = 0; start < CELLS;) {
        if (!some(left[start] >= 0)) {
            start++;
            continue;
        }
        integer slot = MISS;
        for (int lane = 0; lane < LANES; lane++)
            slot = LANE(integer, left[start], lane) >= 0 ? LANE(integer, left[start], lane) : slot;
        int record = record_of[slot];
        simple_normal sn;
        general_tile g;
        general_normal gn;
        if (record >= 0) {
            __global const simple_record *r = simple + record;
            sn = move_simple_normal(r, middle_u - r->centre[0], middle_v - r->centre[1]);
        } else {
            __global const general_record *r = general + ~record;
            g = move_general(r, clips, middle_u, middle_v, near, far);
            gn = move_general_normal(r, middle_u - r->centre[0], middle_v - r->centre[1]);
        }
        for (int cell = start; cell < CELLS; cell++) {
            mask mine = left[cell] == (mask)(slot);
            if (!some(mine))
                continue;
            left[cell] = mine ? (mask)(MISS) : left[cell];
            reals px = ramp + (real)(cell % VECTORS * LANES);
            real py = cell / VECTORS + (real)0.5 - TILE / 2;
#if EXACT
            // Casting compared keys by the error that any root of S may have; this is the winner's own.
            // An upper bound of 1/sqrt(S) will do: binary32 and its rounding up.
            reals inverse_root = FROM_FLOATS(1.000001f / TO_FLOATS(tile->root[cell]));
            if (record >= 0) {
                reals own = sn.key.b + sn.key.s * inverse_root + 4 * UNIT_ROUNDOFF * tile->root[cell];
                tile->slop[cell] = mine ? own : tile->slop[cell];
                // Negated: an infinite bound, or a root of NaN, is in doubt.
                note_doubt(tile, cell, mine & ~(tile->root[cell] >= sn.clear_root), DOUBT_HIT);
            }
#endif
            if (channels & WANT_N) {
                vector3 n;
                if (record >= 0) {
                    n = simple_normal_at(&sn, tile->root[cell], px, py);
#if EXACT
                    n.error = sn.floor + sn.root * tile->root[cell] + sn.root_error * inverse_root;
#endif
                } else {
                    n = general_normal_at(&g, &gn, tile->winner[cell] & 3, f->outward, px, py);
                }
                reals square = n.x * n.x + n.y * n.y + n.z * n.z;
                mask vanishes = mine & ~(square > 0);
#if EXACT
                note_doubt(tile, cell, mine & loose_normal(n.error, square), DOUBT_NORMAL);
#endif
                if (some(vanishes)) {
                    reals u = px + (real)middle_u;
                    real v = py + (real)middle_v;
                    n.x = vanishes ? (real)f->back[0][0] * u + ((real)f->back[0][1] * v + (real)f->back[0][2]) : n.x;
                    n.y = vanishes ? (real)f->back[1][0] * u + ((real)f->back[1][1] * v + (real)f->back[1][2]) : n.y;
                    n.z = vanishes ? (real)f->back[2][0] * u + ((real)f->back[2][1] * v + (real)f->back[2][2]) : n.z;
                    square = n.x * n.x + n.y * n.y + n.z * n.z;
                }
                reals scale = inverse_length(mine ? square : (reals)(1));
                // Adding to +0 turns -0 into +0 and changes nothing else.
                normal[0][cell] += TO_FLOATS(mine ? n.x * scale : (reals)(0));
                normal[1][cell] += TO_FLOATS(mine ? n.y * scale : (reals)(0));
                normal[2][cell] += TO_FLOATS(mine ? n.z * scale : (reals)(0));
            }
        }
    }
    if (channels & WANT_N)
        for (int j = 0; j < 3; j++)
            store_tile(w, plane_of(f, w, planes, WANT_N) + j * w->plane_size, (__private const float *)normal[j]);
}
