# winners.h, inverse_length: the relative error of r + r h (3h/8 + 1/2), h = 1 - q r r, is below 2^-50, q the square.
#
# Everything in units of L = 1 / sqrt(q): r = L (1 + d). Each e is the relative error of one operation, |e| <= u, and zero
# where the compiler fuses. Assumed: d from OpenCL's own least for binary32, 3 ulp for sqrt and 2.5 for the quotient,
# and half a unit for each conversion: below 2^-20; nothing underflows, as 2^-100 <= q <= 2^100.
# kernel winners.h: reals h = 1 - square * r * r;
# kernel winners.h: return r + r * h * (0.375 * h + 0.5);
# refused: |v - 1| <= 0x1p-50 => |v - 1| <= 0x1p-52
# refused: |d| <= 0x1p-20 => |d| <= 0x1p-16
square_rr = (1 + d) * (1 + d) * (1 + e1) * (1 + e2);
h = (1 - square_rr) * (1 + e3);
slope = (0.375 * h * (1 + e4) + 0.5) * (1 + e5);
v = (1 + d + (1 + d) * h * (1 + e6) * slope * (1 + e7)) * (1 + e8);

# The same without roundings.
H = 1 - (1 + d) * (1 + d);
V = 1 + d + (1 + d) * H * (0.375 * H + 0.5);

{ |d| <= 0x1p-20 /\ |e1| <= 0x1p-53 /\ |e2| <= 0x1p-53 /\ |e3| <= 0x1p-53 /\ |e4| <= 0x1p-53 /\ |e5| <= 0x1p-53 /\
  |e6| <= 0x1p-53 /\ |e7| <= 0x1p-53 /\ |e8| <= 0x1p-53 -> |v - 1| <= 0x1p-50 }

V - 1 -> d * d * d * (2.5 + 1.875 * d + 0.375 * d * d);
h - H -> (1 + d) * (1 + d) * (1 - (1 + e1) * (1 + e2)) + (1 - square_rr) * e3;
H -> -d * (2 + d);
1 - square_rr -> H + (1 + d) * (1 + d) * (1 - (1 + e1) * (1 + e2));
v - V -> (1 + d) * (h * (1 + e6) * slope * (1 + e7) - H * (0.375 * H + 0.5))
  + (1 + d + (1 + d) * h * (1 + e6) * slope * (1 + e7)) * e8;
h * (1 + e6) * slope * (1 + e7) - H * (0.375 * H + 0.5) -> (h - H) * (0.375 * H + 0.5) + h * (slope - (0.375 * H + 0.5))
  + h * slope * ((1 + e6) * (1 + e7) - 1);
slope - (0.375 * H + 0.5) -> 0.375 * (h - H) + 0.375 * h * e4 + (0.375 * h * (1 + e4) + 0.5) * e5;
