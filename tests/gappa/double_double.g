# family.h and refine.cl: 2^-98 is above what any one operation on double-doubles may lose, relative to its result (dd.h),
# with u^3 for what is left out there.
# kernel dd.h: dd + dd 3u^2 + 13u^3, dd x dd 5u^2, dd / dd 9.8u^2
# kernel refine.cl: #define DD_ERROR 0x1p-98
# refused: 0x1p-98 => 0x1p-103
u = 0x1p-53;
sum = 3 * u * u + 13 * u * u * u;
product = 5 * u * u;
quotient = 9.8 * u * u;
root = 3.125 * u * u;

{ sum <= 0x1p-98 /\ product <= 0x1p-98 /\ quotient <= 0x1p-98 /\ root <= 0x1p-98 }
