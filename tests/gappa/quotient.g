# candidates.h, the errors of both roots and of the caps: (q + dq) / (a + da) is off by at most (|dq| + |t| |da|) / |a|
# over 1 - x, x = |da| / |a|; the divisor is 64 times its error at least. Twice the first covers it; f is what rounding
# takes off the bound, and t's own rounding is counted as 2u where one u is made.
# kernel candidates.h: #define CLEAR 64.0
# kernel candidates.h: error[ROOT_A] = 2 * (q_error + size_ta * g->a.error) / size_a + 2 * UNIT_ROUNDOFF * size_ta;
# kernel candidates.h: error[ROOT_C] = 2 * (g->c.error + size_tc * q_error) / size_q + 2 * UNIT_ROUNDOFF * size_tc;
# refused: <= 2 => <= 1
# refused: 0.015625 => 0.5
{ x in [0, 0.015625] /\ |f| <= 0x1p-48 -> 1 / ((1 - x) * (1 - f)) <= 2 }
