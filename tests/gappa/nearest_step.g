# certify.h, nearest_step: what comes out is a multiple of 2^-23 and within half a step of the number that went in, fused
# or not (x is the product as it enters the sum).
# kernel certify.h: NORMAL_STEP * 0x1.8p52
# kernel certify.h: return (component * scale + shift) - shift;
# refused: |x| <= 2 => |x| <= 0x1p31
# refused: [-0x1p-24, 0x1p-24] => [-0x1.fp-25, 0x1.fp-25]
@rnd = float<ieee_64, ne>;

shift = 0x1p-23 * 0x1.8p52;
sum = rnd(x + shift);
n = rnd(sum - shift);

{ |x| <= 2 -> @FIX(n, -23) /\ n - x in [-0x1p-24, 0x1p-24] }

sum - shift -> (sum - (x + shift)) + x;
n - x -> (n - (sum - shift)) + (sum - (x + shift));
