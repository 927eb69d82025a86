// SPDX-License-Identifier: Apache-2.0
// Which of the instruction sets that kernels are compiled for this processor has.
#include "backends/cpu/kernel.hpp"
#include "backends/cpu/targets.hpp"

namespace fathom::cpu {

#define FATHOM_CPU_DECLARE(space, bit, name, details)         \
  namespace space {                                           \
  Kernel fourier_kernel(const MetricSpec& spec, Depth depth); \
  Kernel walsh_kernel(const MetricSpec& spec, Depth depth);   \
  Kernel integer_walsh_kernel(const MetricSpec& spec);        \
  Kernel cosine_kernel(const MetricSpec& spec, Depth depth);  \
  }
FATHOM_CPU_TARGETS(FATHOM_CPU_DECLARE)
#undef FATHOM_CPU_DECLARE

Kernel InstructionSet::kernel(const MetricSpec& spec, Depth depth) const {
  switch (spec.transform) {
    case Transform::fft:
      return fourier(spec, depth);
    case Transform::walsh_paley:
    case Transform::walsh_sequency:
    case Transform::walsh_hadamard: {
      const bool fits_integers = spec.is_exact() && depth == Depth::bits8;
      return fits_integers ? integer_walsh(spec) : walsh(spec, depth);
    }
    case Transform::dct:
      return cosine(spec, depth);
  }
  return {};
}

namespace {

/// Whether processor and system have all that code for one of Highway's targets may use. The
/// compiler's own test (LZCNT and F16C come with AVX2 and FMA on every processor), because
/// Highway's library would spend 3 ms at every start on its timers.
bool has(std::int64_t target) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool sse4 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("pclmul") &&
                    __builtin_cpu_supports("aes");
  const bool avx2 = sse4 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool avx3 = avx2 && __builtin_cpu_supports("avx512f") &&
                    __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  return target == HWY_SSE4 ? sse4 : target == HWY_AVX2 ? avx2 : target == HWY_AVX3 && avx3;
#else
  // NEON without the cryptography extension (targets.hpp), which every 64-bit ARM has.
  return (target & HWY_ENABLED_BASELINE) != 0;
#endif
}

}  // namespace

std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> sets;
#define FATHOM_CPU_LIST(space, bit, name, details)                               \
  if (has(bit)) {                                                                \
    sets.push_back({name, details, &space::fourier_kernel, &space::walsh_kernel, \
                    &space::integer_walsh_kernel, &space::cosine_kernel});       \
  }
  FATHOM_CPU_TARGETS(FATHOM_CPU_LIST)
#undef FATHOM_CPU_LIST
  return sets;
}

}  // namespace fathom::cpu
