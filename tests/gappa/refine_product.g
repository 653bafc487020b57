# refine.cl, bounded_product: double-doubles A and B that are off by a and b make a product off by |A| b + |B| a + a b, and
# 1.01 covers that sizes are those of the leading parts alone (h, k) and the roundings of the bound itself (f).
# kernel refine.cl: double4 error = fabs(a.value.hi) * b.error + fabs(b.value.hi) * a.error + a.error * b.error;
# kernel refine.cl: 1.01 * error + DD_ERROR * fabs(product.hi)
# refused: <= 1.01 => <= 1
{ |h| <= 0x1p-53 /\ |f| <= 0x1p-50 -> (1 + h) / (1 - f) <= 1.01 }
