# refine.cl, bounded_root: a square that is 16 times its error x at least, in units of the square, has a root that is off
# by x / root at most; f is what rounding takes off the bound.
# kernel refine.cl: a.value.hi >= 16.0 * a.error ? a.error / root.hi + DD_ERROR * root.hi
# refused: <= 1 => <= 0.5
per_x = 1 / (1 + sqrt(1 - x));

{ x in [0, 0.0625] /\ |f| <= 0x1p-48 -> per_x / (1 - f) <= 1 }
