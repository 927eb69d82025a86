// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/programs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "backends/opencl/source.hpp"
#include "engine/cache.hpp"
#include "engine/error.hpp"

namespace fathom::opencl {
namespace {

const char* file_of(gpu::Kernel kernel) {
  switch (kernel) {
    case gpu::Kernel::fft:
      return "fft.cl";
    case gpu::Kernel::walsh_float:
    case gpu::Kernel::walsh_integer:
      return "walsh.cl";
    case gpu::Kernel::exact:
      break;
  }
  return "exact.cl";
}

struct Macro {
  int id;
  const char* name;
};
constexpr Macro kMacros[] = {
    {FATHOM_WORKGROUP, "WORKGROUP"}, {FATHOM_N, "N"},
    {FATHOM_POINTS, "POINTS"},       {FATHOM_LINES, "LINES"},
    {FATHOM_TEAMS, "TEAMS"},         {FATHOM_TOUCHED, "TOUCHED"},
    {FATHOM_POWER, "POWER"},         {FATHOM_BANDED, "BANDED"},
    {FATHOM_PLANES, "PLANES"},       {FATHOM_IS_WALSH, "IS_WALSH"},
    {FATHOM_WANTED, "WANTED"},       {FATHOM_BYTES, "BYTES"},
    {FATHOM_PADDED, "PADDED"},       {FATHOM_LANES, "LANES"},
    {FATHOM_ON_CHIP, "ON_CHIP"},     {FATHOM_RINGS, "RINGS"},
    {FATHOM_LESS_MEAN, "LESS_MEAN"}, {FATHOM_IS_COSINE, "IS_COSINE"},
    {FATHOM_ENTROPY, "ENTROPY"},
};
static_assert(std::size(kMacros) == FATHOM_CONSTANTS);

std::string options_of(gpu::Kernel kernel, const gpu::Constants& constants) {
  // No relaxed mathematics: the scores' error is derived from IEEE 754 (docs/metrics.md).
  std::string options = "-cl-std=CL1.2 -w";
  for (const Macro& macro : kMacros)
    options += fmt::format(" -D{}={}", macro.name, constants[macro.id]);
  if (kernel == gpu::Kernel::walsh_float) options += " -DIN_FLOAT";
  return options;
}

/// What a compiler says first, on one line.
std::string complaint(cl_program program, cl_device_id device) {
  std::size_t bytes = 0;
  cl().GetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
  std::string log(bytes, '\0');
  if (bytes > 0) {
    cl().GetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
  }
  log.resize(std::min({log.size(), log.find('\0'), std::size_t{300}}));
  std::replace(log.begin(), log.end(), '\n', ' ');
  return log.empty() ? "its compiler says nothing" : log;
}

}  // namespace

const char* kernel_name(gpu::Kernel kernel) {
  switch (kernel) {
    case gpu::Kernel::fft:
      return "fft";
    case gpu::Kernel::walsh_float:
    case gpu::Kernel::walsh_integer:
      return "walsh";
    case gpu::Kernel::exact:
      break;
  }
  return "exact";
}

const std::string& kernels_key() {
  static const std::string key = [] {
    std::uint64_t hash = hash_of("");
    for (const gpu::Kernel kernel : gpu::kAllKernels) hash = hash_of(source(file_of(kernel)), hash);
    return fmt::format("{:016x}", hash);
  }();
  return key;
}

Handle<cl_program> Programs::build(gpu::Kernel kernel, const std::string& options) const {
  const std::string text = source(file_of(kernel));
  const char* start = text.data();
  const std::size_t length = text.size();
  cl_int result = CL_SUCCESS;
  Handle<cl_program> program(cl().CreateProgramWithSource(context_, 1, &start, &length, &result));
  check(result, "a program");
  result = cl().BuildProgram(program.get(), 1, &device_, options.c_str(), nullptr, nullptr);
  if (result == CL_BUILD_PROGRAM_FAILURE) {
    throw Error(ErrorCode::unavailable,
                fmt::format("opencl: compiling {} failed: {}", file_of(kernel),
                            complaint(program.get(), device_)));
  }
  check(result, "compiling a kernel");
  return program;
}

/// PoCL has a cache of its own, in which processes that compile at the same time disturb each other:
/// some builds of a program fail then that succeed a moment later.
Handle<cl_program> Programs::compile(gpu::Kernel kernel, const std::string& options) const {
  constexpr int kMostFailures = 2;
  for (int failures = 0;; ++failures) {
    try {
      return build(kernel, options);
    } catch (const Error&) {
      if (failures == kMostFailures) throw;
    }
  }
}

/// Null where there is nothing to load.
Handle<cl_program> Programs::load(gpu::Kernel of, const std::string& file,
                                  const std::string& options) const {
  const auto binary = read_cached(file, kernels_key() + options);
  if (!binary) return {};
  const auto* bytes = reinterpret_cast<const unsigned char*>(binary->data());
  const std::size_t length = binary->size();
  cl_int is_right = CL_SUCCESS, result = CL_SUCCESS;
  Handle<cl_program> program(
      cl().CreateProgramWithBinary(context_, 1, &device_, &length, &bytes, &is_right, &result));
  if (result != CL_SUCCESS || is_right != CL_SUCCESS) return {};
  result = cl().BuildProgram(program.get(), 1, &device_, options.c_str(), nullptr, nullptr);
  if (result != CL_SUCCESS) return {};
  const Handle<cl_kernel> kernel(cl().CreateKernel(program.get(), kernel_name(of), &result));
  return result == CL_SUCCESS ? std::move(program) : Handle<cl_program>();
}

void Programs::keep(cl_program program, const std::string& file, const std::string& options) const {
  if (cache_folder().empty()) return;  // PoCL compiles once more for what it hands out
  std::size_t length = 0;
  if (cl().GetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof length, &length, nullptr) !=
          CL_SUCCESS ||
      length == 0) {
    return;
  }
  std::string binary(length, '\0');
  char* start = binary.data();
  if (cl().GetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof start, &start, nullptr) !=
      CL_SUCCESS) {
    return;
  }
  write_cached(file, kernels_key() + options, binary);
}

cl_program Programs::get(gpu::Kernel kernel, const gpu::Constants& constants) {
  // Plans that want the same wait for the one that compiles it.
  const std::lock_guard lock(mutex_);
  const auto known = programs_.find({kernel, constants});
  if (known != programs_.end()) return known->second.get();
  const std::string options = options_of(kernel, constants);
  const std::string file =
      fmt::format("{}-{}-{:016x}.program", name_, kernel_name(kernel), hash_of(options));
  Handle<cl_program> program = load(kernel, file, options);
  if (program.get() == nullptr) {
    const CacheLock one_compiles("opencl");
    program = load(kernel, file, options);
    if (program.get() == nullptr) {
      program = compile(kernel, options);
      keep(program.get(), file, options);
    }
  }
  return programs_.emplace(std::pair(kernel, constants), std::move(program)).first->second.get();
}

}  // namespace fathom::opencl
