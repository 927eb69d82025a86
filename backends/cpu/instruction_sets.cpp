// SPDX-License-Identifier: Apache-2.0
// Which of the instruction sets that kernels are compiled for this processor has.
#include "backends/cpu/kernel.hpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which there are.
#include <hwy/targets.h>

namespace fathom::cpu {

#define FATHOM_CPU_DECLARE(space, bit, name, details)         \
  namespace space {                                           \
  Kernel fourier_kernel(const MetricSpec& spec, Depth depth); \
  Kernel walsh_kernel(const MetricSpec& spec, Depth depth);   \
  Kernel exact_walsh_kernel(const MetricSpec& spec);          \
  }
FATHOM_CPU_TARGETS(FATHOM_CPU_DECLARE)
#undef FATHOM_CPU_DECLARE

Kernel InstructionSet::kernel(const MetricSpec& spec, Depth depth) const {
  if (!is_walsh(spec.transform)) return fourier(spec, depth);
  const bool fits_integers = spec.is_exact() && depth == Depth::bits8;
  return fits_integers ? exact_walsh(spec) : walsh(spec, depth);
}

std::vector<InstructionSet> instruction_sets() {
  const auto supported = hwy::SupportedTargets();
  std::vector<InstructionSet> sets;
#define FATHOM_CPU_LIST(space, bit, name, details)                               \
  if (supported & (bit)) {                                                       \
    sets.push_back({name, details, &space::fourier_kernel, &space::walsh_kernel, \
                    &space::exact_walsh_kernel});                                \
  }
  FATHOM_CPU_TARGETS(FATHOM_CPU_LIST)
#undef FATHOM_CPU_LIST
  return sets;
}

}  // namespace fathom::cpu
