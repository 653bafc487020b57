# winners.h, store_normals: a component of the gradient as computed, scaled to unit length, is within 12u of x, exact: with
# s the square's relative error (three roundings in a sum of positive terms), d that of inverse_length (inverse_length.g),
# p that of the product, and q those of the distance to the step and of the slack, no larger than half a step each.
# kernel winners.h: reals square = n.x * n.x + n.y * n.y + n.z * n.z;
# kernel winners.h: (0.5 * NORMAL_STEP - 12 * UNIT_ROUNDOFF)
# refused: 0xcp-53 => 0xap-53
component = x * (1 + d) * (1 + p) / sqrt(1 + s);

{ |x| <= 1 /\ |s| <= 0x3.00000001p-53 /\ |d| <= 0x1p-50 /\ |p| <= 0x1p-53 /\ |q| <= 0x1p-75 ->
  |component - x + q| <= 0xcp-53 }

component - x -> x * ((1 + d) * (1 + p) / sqrt(1 + s) - 1) { sqrt(1 + s) <> 0 };
