// SPDX-License-Identifier: Apache-2.0
// Numbers of some 46 bits as unevaluated sums of two floats, x + y with |y| <= ulp(x)/2, for GPUs
// whose doubles are slow or missing (Dekker 1971; Knuth, TAOCP 2, 4.2.2). `precise` keeps the
// compiler from simplifying what only makes sense in floating point.

vec2 two_sum(float a, float b) {
  precise const float s = a + b;
  precise const float t = s - a;
  precise const float e = (a - (s - t)) + (b - t);
  return vec2(s, e);
}

// For |a| >= |b|.
vec2 quick_two_sum(float a, float b) {
  precise const float s = a + b;
  precise const float e = b - (s - a);
  return vec2(s, e);
}

// In two halves of 12 bits, whose products are exact.
vec2 halves(float a) {
  precise const float t = a * 4097.0;
  precise const float high = t - (t - a);
  precise const float low = a - high;
  return vec2(high, low);
}

vec2 two_product(float a, float b) {
  precise const float p = a * b;
  const vec2 x = halves(a), y = halves(b);
  precise const float e = ((x.x * y.x - p) + x.x * y.y + x.y * y.x) + x.y * y.y;
  return vec2(p, e);
}

vec2 df_add(vec2 a, vec2 b) {
  const vec2 s = two_sum(a.x, b.x), t = two_sum(a.y, b.y);
  precise const float low = s.y + t.x;
  const vec2 u = quick_two_sum(s.x, low);
  precise const float rest = u.y + t.y;
  return quick_two_sum(u.x, rest);
}

vec2 df_mul(vec2 a, vec2 b) {
  const vec2 p = two_product(a.x, b.x);
  precise const float low = p.y + (a.x * b.y + a.y * b.x);
  return quick_two_sum(p.x, low);
}

// One step of Newton's method from the root of the upper half.
vec2 df_sqrt(vec2 a) {
  if (!(a.x > 0)) return vec2(0);
  const float root = sqrt(a.x);
  const vec2 error = df_add(a, -two_product(root, root));
  precise const float correction = error.x / (2 * root);
  return quick_two_sum(root, correction);
}
