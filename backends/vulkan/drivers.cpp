// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/drivers.hpp"

#include "backends/gpu/drivers.hpp"
#include "backends/vulkan/api.hpp"
#include "backends/vulkan/spirv.hpp"
#include "engine/error.hpp"

namespace fathom::vulkan {
namespace {

namespace fs = std::filesystem;

/// Where the loader looks for manifests (Vulkan-Loader, LoaderDriverInterface.md, "Driver
/// Discovery on Linux").
std::vector<fs::path> folders() {
  std::vector<fs::path> found;
  const auto add = [&](const char* variable, const char* otherwise) {
    auto paths = gpu::paths_in(variable);
    if (paths.empty()) {
      for (const fs::path& path : gpu::paths_in("HOME")) {
        if (otherwise[0] != '/') paths.push_back(path / otherwise);
      }
      if (otherwise[0] == '/') paths.emplace_back(otherwise);
    }
    found.insert(found.end(), paths.begin(), paths.end());
  };
  add("XDG_CONFIG_HOME", ".config");
  add("XDG_CONFIG_DIRS", "/etc/xdg");
  add("XDG_DATA_HOME", ".local/share");
  add("XDG_DATA_DIRS", "/usr/local/share");
  for (const char* folder : {"/usr/share", "/usr/local/etc", "/etc"}) found.emplace_back(folder);
  return found;
}

}  // namespace

std::string drivers() {
  try {
    require_loader();
  } catch (const Error&) {
    return {};
  }
  std::string text = kernels_key() + "\n" + gpu::machine_identity();
  text += gpu::library_identity(reinterpret_cast<const void*>(vkGetInstanceProcAddr));
  for (const fs::path& folder : folders()) {
    for (const char* kind : {"icd.d", "implicit_layer.d", "explicit_layer.d"}) {
      text += gpu::folder_identity(folder / "vulkan" / kind, ".json");
    }
  }
  for (const char* variable : {"VK_ICD_FILENAMES", "VK_DRIVER_FILES", "VK_ADD_DRIVER_FILES"}) {
    for (const fs::path& path : gpu::paths_in(variable)) {
      text += gpu::file_identity(path) + gpu::file_identity(gpu::library_named(path));
    }
  }
  return text;
}

}  // namespace fathom::vulkan
