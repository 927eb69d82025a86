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

// One step of Newton's method from 1 over the upper half.
vec2 df_inverse(vec2 a) {
  const float inverse = 1.0 / a.x;
  const vec2 error = df_add(vec2(1, 0), -df_mul(a, vec2(inverse, 0)));
  precise const float correction = inverse * error.x;
  return quick_two_sum(inverse, correction);
}

// log2 of a number from 2^-100 to 1, to a relative error of 1e-6 near 1, too. Not the builtin one,
// which may be off by 2^-21 there. With s = (m - 1)/(m + 1), log2 m = 2/ln 2 (s + s^3/3 + ..).
float df_log2(vec2 a) {
  const int bits = floatBitsToInt(a.x);
  int exponent = (bits >> 23) - 127;
  float m = intBitsToFloat((bits & 0x7fffff) | 0x3f800000);
  if (m > 1.41421356) {
    m *= 0.5;
    ++exponent;
  }
  precise const float s = (m - 1.0) / (m + 1.0);
  precise const float z = s * s;
  const float series = 1.0 + z * (1.0 / 3.0 + z * (0.2 + z * (1.0 / 7.0 + z * (1.0 / 9.0))));
  const float rest = 1.44269504 * (a.y / a.x);
  return float(exponent) + (2.88539008 * s * series + rest);
}

// One step of Newton's method from the root of the upper half.
vec2 df_sqrt(vec2 a) {
  if (!(a.x > 0)) return vec2(0);
  const float root = sqrt(a.x);
  const vec2 error = df_add(a, -two_product(root, root));
  precise const float correction = error.x / (2 * root);
  return quick_two_sum(root, correction);
}
