// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/spirv.hpp"

#include <fmt/format.h>

#include "engine/cache.hpp"

namespace fathom::vulkan {
namespace {

// Written by glslc from kernels/ (cmake/FathomKernels.cmake).
constexpr std::uint32_t kFft[] = {
#include "fft.spirv"
};
constexpr std::uint32_t kWalshFloat[] = {
#include "walsh_float.spirv"
};
constexpr std::uint32_t kWalshInteger[] = {
#include "walsh_integer.spirv"
};
constexpr std::uint32_t kExact[] = {
#include "exact.spirv"
};

}  // namespace

std::span<const std::uint32_t> spirv(gpu::Kernel kernel) {
  switch (kernel) {
    case gpu::Kernel::fft:
      return kFft;
    case gpu::Kernel::walsh_float:
      return kWalshFloat;
    case gpu::Kernel::walsh_integer:
      return kWalshInteger;
    case gpu::Kernel::exact:
      return kExact;
  }
  return {};
}

const std::string& kernels_key() {
  static const std::string key = [] {
    std::uint64_t hash = hash_of("");
    for (const gpu::Kernel kernel : gpu::kAllKernels) {
      const auto code = spirv(kernel);
      hash = hash_of({reinterpret_cast<const char*>(code.data()), code.size_bytes()}, hash);
    }
    return fmt::format("{:016x}", hash);
  }();
  return key;
}

}  // namespace fathom::vulkan
