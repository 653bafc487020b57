# refine.cl, bounded_quotient: divisors are 16 times their error at least, and 1.1 covers 1 / (1 - 1/16), the roundings of
# the bound itself, f, and that sizes are those of the leading parts alone.
# kernel refine.cl: error = 1.1 * (a.error + fabs(quotient.hi) * b.error) / size
# kernel refine.cl: size >= 16.0 * b.error
# refused: <= 1.1 => <= 1.06
# refused: 0.0625 => 0.125
{ x in [0, 0.0625] /\ |f| <= 0x1p-48 -> 1 / ((1 - x) * (1 - f)) <= 1.1 }
