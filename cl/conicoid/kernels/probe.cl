// What double-double needs of a device, seen at run time: a * a rounds 2^-60 away for a = 1 + 2^-30.

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void probe_arithmetic(double a, __global double *answer)
{
    dd square = two_product((double4)(a), (double4)(a));
    double p = a * a;
    answer[0] = square.lo.s0;   // 2^-60 with a true fma, 0 without
    answer[1] = a * a - p;      // 0, unless the compiler contracts what it was told not to
    answer[2] = square.lo.s3;
    answer[3] = two_sum((double4)(a), (double4)(a * 0x1p-90)).lo.s0;    // a 2^-90, unless terms were re-associated
}
