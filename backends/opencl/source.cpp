// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/source.hpp"

#include <fmt/format.h>

#include <map>

namespace fathom::opencl {
namespace {

// Written from kernels/ (cmake/FathomKernels.cmake).
constexpr char kArgs[] = {
#include "args.h.text"
};
constexpr char kWindow[] = {
#include "window.clh.text"
};
constexpr char kDoubleFloat[] = {
#include "double_float.clh.text"
};
constexpr char kRings[] = {
#include "rings.clh.text"
};
constexpr char kFftRings[] = {
#include "fft_rings.clh.text"
};
constexpr char kWalshRings[] = {
#include "walsh_rings.clh.text"
};
constexpr char kFft[] = {
#include "fft.cl.text"
};
constexpr char kWalsh[] = {
#include "walsh.cl.text"
};
constexpr char kExact[] = {
#include "exact.cl.text"
};

template <std::size_t size>
constexpr std::string_view text(const char (&bytes)[size]) {
  return {bytes, size};
}

}  // namespace

std::string source(std::string_view file) {
  static const std::map<std::string_view, std::string_view> files = {
      {"args.h", text(kArgs)},
      {"window.clh", text(kWindow)},
      {"double_float.clh", text(kDoubleFloat)},
      {"rings.clh", text(kRings)},
      {"fft_rings.clh", text(kFftRings)},
      {"walsh_rings.clh", text(kWalshRings)},
      {"fft.cl", text(kFft)},
      {"walsh.cl", text(kWalsh)},
      {"exact.cl", text(kExact)}};
  constexpr std::string_view kInclude = "#include \"";
  std::string all = fmt::format("#line 1 \"{}\"\n", file);
  std::string_view rest = files.at(file);
  for (int line = 1; !rest.empty(); ++line) {
    const std::string_view text =
        rest.substr(0, rest.find('\n') + 1);  // files end with a line's end
    rest.remove_prefix(text.size());
    if (text.starts_with(kInclude)) {
      const std::string_view name = text.substr(kInclude.size(), text.rfind('"') - kInclude.size());
      all += source(name) + fmt::format("#line {} \"{}\"\n", line + 1, file);
    } else {
      all += text;
    }
  }
  return all;
}

}  // namespace fathom::opencl
