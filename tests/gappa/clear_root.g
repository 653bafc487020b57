# simple.h, unclear_root: what is kept is at least 8E for certain. Two roundings of the root, squared, one of the square,
# one of the right-hand side, one of the constant. In units of E.
# kernel simple.h: root * root >= (real)(8.01 * r->s_error)
# refused: 8.01 => 8.0
kept = 8.01 * (1 + e1) * (1 + e2);
s = kept / ((1 + e3) * (1 + e4) * (1 + e4));

{ |e1| <= 0x1p-53 /\ |e2| <= 0x1p-53 /\ |e3| <= 0x1p-53 /\ |e4| <= 0x1p-53 -> s >= 8 }
