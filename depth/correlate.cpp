// SPDX-License-Identifier: Apache-2.0
#include "depth/correlate.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/correlate.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fathom::depth::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kFociMultiple>;
using V = hn::Vec<D>;

HWY_ATTR V squared(V correlation) {
  const D d;
  const V above = hn::Max(correlation, hn::Zero(d));
  return hn::Mul(above, above);
}

/// Calls finish(focus, c^2) for the foci in each register.
template <class Finish>
HWY_ATTR void correlate(const RingAndLaw& ring, const Finish& finish) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int focus = 0;
  for (; focus + 4 * lanes <= ring.foci; focus += 4 * lanes) {
    V a = hn::Zero(d), b = a, c = a, e = a;
    const float* law = ring.law + focus;
    for (int z = 0; z < ring.frames; ++z, law += ring.foci) {
      const V power = hn::Set(d, ring.powers[z]);
      a = hn::MulAdd(power, hn::LoadU(d, law), a);
      b = hn::MulAdd(power, hn::LoadU(d, law + lanes), b);
      c = hn::MulAdd(power, hn::LoadU(d, law + 2 * lanes), c);
      e = hn::MulAdd(power, hn::LoadU(d, law + 3 * lanes), e);
    }
    finish(focus, squared(a));
    finish(focus + lanes, squared(b));
    finish(focus + 2 * lanes, squared(c));
    finish(focus + 3 * lanes, squared(e));
  }
  for (; focus < ring.foci; focus += lanes) {
    V a = hn::Zero(d);
    const float* law = ring.law + focus;
    for (int z = 0; z < ring.frames; ++z, law += ring.foci) {
      a = hn::MulAdd(hn::Set(d, ring.powers[z]), hn::LoadU(d, law), a);
    }
    finish(focus, squared(a));
  }
}

HWY_ATTR void explained(const RingAndLaw& ring, float weight, float* sums) {
  const D d;
  const V factor = hn::Set(d, weight);
  correlate(ring, [&](int focus, V square) HWY_ATTR {
    hn::StoreU(hn::MulAdd(factor, square, hn::LoadU(d, sums + focus)), d, sums + focus);
  });
}

HWY_ATTR void likeness(const RingAndLaw& ring, float part, float count, float* sums) {
  const D d;
  const V one = hn::Set(d, 1.0f), factor = hn::Set(d, part), times = hn::Set(d, count);
  correlate(ring, [&](int focus, V square) HWY_ATTR {
    const V left = hn::Log(d, hn::NegMulAdd(factor, square, one));
    hn::StoreU(hn::NegMulAdd(times, left, hn::LoadU(d, sums + focus)), d, sums + focus);
  });
}

}  // namespace

// What is dispatched to must be visible.
void AddExplained(const RingAndLaw& ring, float weight, float* sums) {
  explained(ring, weight, sums);
}
void AddLikeness(const RingAndLaw& ring, float part, float count, float* sums) {
  likeness(ring, part, count, sums);
}

}  // namespace fathom::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fathom::depth {

HWY_EXPORT(AddExplained);
HWY_EXPORT(AddLikeness);

void add_explained(const RingAndLaw& ring, float weight, float* sums) {
  HWY_DYNAMIC_DISPATCH(AddExplained)(ring, weight, sums);
}

void add_likeness(const RingAndLaw& ring, float part, float count, float* sums) {
  HWY_DYNAMIC_DISPATCH(AddLikeness)(ring, part, count, sums);
}

}  // namespace fathom::depth
#endif
