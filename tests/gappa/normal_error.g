# winners.h, store_normals: a gradient that is off by e has a direction off by e / (|n| - e) at most, and 1.01 e times the
# scale is more, or more than half a step, which leaves the pixel open. r and wide are e / |n|, f what rounding takes off.
# kernel winners.h: (0.5 * NORMAL_STEP - 12 * UNIT_ROUNDOFF) - 1.01 * n.error * to_unit
# refused: per_r / (1 - f) <= 1.01 => per_r / (1 - f) <= 1.001
# refused: wide in [0.005 => wide in [0x1p-25
per_r = 1 / (1 - r);

{ |f| <= 0x1p-48 /\ r in [0, 0.005] /\ wide in [0.005, 0x1p1000] ->
  per_r / (1 - f) <= 1.01 /\ 1.01 * wide * (1 - f) >= 0x1p-24 }
