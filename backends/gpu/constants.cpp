// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/constants.hpp"

#include "backends/gpu/tables.hpp"

namespace fathom::gpu {

namespace {

/// FATHOM_BANDED, FATHOM_RINGS, FATHOM_LESS_MEAN and FATHOM_ENTROPY: what is made of the coefficients.
void set_measure(Constants& constants, const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
      constants[FATHOM_BANDED] = spec.band.has_value();
      return;
    case Measure::rings:
      constants[FATHOM_RINGS] = static_cast<std::uint32_t>(spec.rings);
      constants[FATHOM_LESS_MEAN] = spec.subtracts_mean();
      return;
    case Measure::entropy:
      constants[FATHOM_BANDED] = spec.band.has_value();
      constants[FATHOM_ENTROPY] = 1;
      return;
  }
}

/// FATHOM_IS_WALSH and FATHOM_IS_COSINE; neither of the Fourier transform.
void set_family(Constants& constants, const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return;
    case TransformFamily::walsh:
      constants[FATHOM_IS_WALSH] = 1;
      return;
    case TransformFamily::cosine:
      constants[FATHOM_IS_COSINE] = 1;
      return;
  }
}

}  // namespace

Constants constants_of(const MetricSpec& spec, const Shape& shape, Depth depth, Wanted wanted) {
  // What a kernel does not ask for stays 0, so that metrics that differ in it alone share what is
  // compiled.
  Constants constants = {};
  constants[FATHOM_WORKGROUP] = static_cast<std::uint32_t>(shape.threads);
  constants[FATHOM_N] = static_cast<std::uint32_t>(spec.n);
  constants[FATHOM_POINTS] = static_cast<std::uint32_t>(shape.points);
  constants[FATHOM_LINES] = static_cast<std::uint32_t>(shape.lines);
  constants[FATHOM_TEAMS] = static_cast<std::uint32_t>(shape.teams);
  if (shape.kernel == Kernel::fft) {
    constants[FATHOM_TOUCHED] = static_cast<std::uint32_t>(touched_frequency(spec));
  }
  constants[FATHOM_POWER] = spec.power;
  if (wanted == Wanted::score) set_measure(constants, spec);
  constants[FATHOM_PLANES] = static_cast<std::uint32_t>(shape.planes);
  set_family(constants, spec);
  constants[FATHOM_WANTED] = static_cast<std::uint32_t>(wanted);
  constants[FATHOM_BYTES] = static_cast<std::uint32_t>(bytes_per_pixel(depth));
  constants[FATHOM_PADDED] = shape.is_padded;
  constants[FATHOM_LANES] = static_cast<std::uint32_t>(shape.lanes);
  constants[FATHOM_ON_CHIP] = shape.lanes > 1 && shape.scratch_bytes == 0;
  return constants;
}

}  // namespace fathom::gpu
