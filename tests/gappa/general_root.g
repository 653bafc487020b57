# candidates.h, root_error: where S = 1 is at least 64 times its error x, its root is off by at most x / root, of which
# half and a little is needed; f is what rounding takes off the bound.
# kernel candidates.h: reals root_error = g->s.error > 0 ? g->s.error / root : (reals)(0);
# kernel candidates.h: #define CLEAR 64.0
# refused: <= 1 => <= 0.5
per_x = 1 / (1 + sqrt(1 - x));          # (1 - sqrt(1 - x)) / x, the worse of the two sides

{ x in [0, 0.015625] /\ |f| <= 0x1p-50 -> per_x / (1 - f) <= 1 }
