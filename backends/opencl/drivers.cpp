// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/drivers.hpp"

#include "backends/gpu/drivers.hpp"
#include "backends/opencl/api.hpp"
#include "backends/opencl/programs.hpp"
#include "engine/error.hpp"

namespace fathom::opencl {
namespace {

namespace fs = std::filesystem;

const void* function_of_the_loader() {
  try {
    return reinterpret_cast<const void*>(cl().GetPlatformIDs);
  } catch (const Error&) {
    return nullptr;
  }
}

}  // namespace

std::string drivers() {
  const void* const function = function_of_the_loader();
  if (function == nullptr) return {};
  std::string text = kernels_key() + "\n" + gpu::machine_identity();
  text += gpu::library_identity(function);
  // Where loaders look for drivers: ocl-icd's variable names a folder or a driver, Khronos' too.
  text += gpu::folder_identity("/etc/OpenCL/vendors", ".icd");
  text += gpu::folder_identity("/etc/OpenCL/layers", ".lay");
  for (const char* variable :
       {"OCL_ICD_VENDORS", "OPENCL_VENDOR_PATH", "OCL_ICD_FILENAMES", "OPENCL_LAYERS"}) {
    for (const fs::path& path : gpu::paths_in(variable)) {
      text += gpu::file_identity(path) + gpu::folder_identity(path, ".icd");
      if (path.extension() == ".icd") text += gpu::file_identity(gpu::library_named(path));
    }
  }
  return text;
}

}  // namespace fathom::opencl
