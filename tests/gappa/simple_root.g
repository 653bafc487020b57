# simple.h, simple_root_error: S, raised by its error E, is at most 2E too large, and where it is at least 8E that moves
# its root by at most 1.08 E / root. In units of S: x = E / S.
#
# f is what rounding takes off the bound: the root itself, three conversions to binary32 and its product within half a
# unit, its quotient within OpenCL's 2.5.
# kernel simple.h: (floats)(r->s_error * 1.08f + 0x1p-120f) / TO_FLOATS(root)
# kernel simple.h: root * root >= (real)(8.01 * r->s_error)
# refused: 1.08 => 1.07
# refused: x in [0, 0.125] => x in [0, 0.16]
per_x = 2 / (1 + sqrt(1 - 2 * x));      # (1 - sqrt(1 - 2x)) / x

{ x in [0, 0.125] /\ |f| <= 0x1p-20 -> per_x / (1 - f) <= 1.08 }
