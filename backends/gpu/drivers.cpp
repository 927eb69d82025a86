// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/drivers.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "engine/error.hpp"
#include "engine/file.hpp"

extern char** environ;

namespace fathom::gpu {
namespace {

namespace fs = std::filesystem;

/// What loaders and drivers obey; a list, because most of what a shell sets changes all the time.
constexpr std::string_view kPrefixes[] = {
    "VK_",  "OCL_", "OPENCL_",  "POCL_", "RUSTICL_", "CLOVER_",   "MESA_", "LIBGL_",
    "LVP_", "LP_",  "GALLIUM_", "CUDA_", "NVIDIA_",  "__NV",      "ROCR_", "HIP_",
    "HSA_", "GPU_", "AMD_",     "RADV_", "ANV_",     "INTEL_",    "NEO",   "ZE_",
    "DRI_", "NVK_", "ZINK_",    "LD_",   "XDG_DATA", "XDG_CONFIG"};

constexpr const char* kLibraryFolders[] = {"/usr/lib/x86_64-linux-gnu",
                                           "/usr/lib/aarch64-linux-gnu",
                                           "/usr/local/lib",
                                           "/usr/lib64",
                                           "/usr/lib",
                                           "/lib64",
                                           "/lib"};

/// A manifest is small; what is not is no manifest.
constexpr std::uintmax_t kLargestManifest = 1 << 20;

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code problem;
  for (fs::directory_iterator at(folder, problem), end; !problem && at != end;
       at.increment(problem)) {
    files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The text between the quotes after "library_path" and its colon.
std::string library_in_json(const std::string& json) {
  std::size_t at = json.find("\"library_path\"");
  if (at == std::string::npos) return {};
  at = json.find('"', json.find(':', at));
  if (at == std::string::npos) return {};
  const std::size_t end = json.find('"', at + 1);
  return end == std::string::npos ? std::string() : json.substr(at + 1, end - at - 1);
}

fs::path found_by_name(const std::string& name) {
  std::vector<fs::path> folders = paths_in("LD_LIBRARY_PATH");
  folders.insert(folders.end(), std::begin(kLibraryFolders), std::end(kLibraryFolders));
  for (const fs::path& folder : folders) {
    std::error_code problem;
    if (fs::exists(folder / name, problem)) return folder / name;
  }
  return name;
}

/// Device files, with what this user may do: a driver without that lists nothing.
std::string device_files() {
  std::vector<fs::path> files = files_in("/dev/dri");
  for (const fs::path& file : files_in("/dev")) {
    const std::string name = file.filename();
    const bool is_gpu =
        name.starts_with("nvidia") || name.starts_with("mali") || name == "kfd" || name == "dxg";
    if (is_gpu) files.push_back(file);
  }
  std::string text;
  for (const fs::path& file : files) {
    text += fmt::format("{} {}\n", file.string(), access(file.c_str(), R_OK | W_OK));
  }
  return text;
}

std::string variables() {
  std::vector<std::string> found;
  for (char** at = environ; *at != nullptr; ++at) {
    const std::string_view variable = *at;
    if (std::any_of(std::begin(kPrefixes), std::end(kPrefixes),
                    [&](std::string_view prefix) { return variable.starts_with(prefix); })) {
      found.emplace_back(variable);
    }
  }
  std::sort(found.begin(), found.end());
  std::string text;
  for (const std::string& variable : found) text += variable + "\n";
  return text;
}

std::string kernel() {
  utsname names = {};
  uname(&names);
  return fmt::format("{} {} {}\n", names.sysname, names.release, names.version);
}

}  // namespace

std::vector<fs::path> paths_in(const char* variable) {
  const char* const value = std::getenv(variable);
  std::vector<fs::path> paths;
  if (value == nullptr) return paths;
  std::string_view rest = value;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) paths.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return paths;
}

std::string file_identity(const fs::path& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0) return path.string() + " -\n";
  return fmt::format("{} {} {}.{:09} {}\n", path.string(), status.st_size, status.st_mtim.tv_sec,
                     status.st_mtim.tv_nsec, status.st_ino);
}

fs::path library_named(const fs::path& manifest) {
  std::string text;
  try {
    text = read_file(manifest, kLargestManifest);
  } catch (const Error&) {
    return {};
  }
  const bool is_json = manifest.extension() == ".json";
  const std::string library =
      is_json ? library_in_json(text) : text.substr(0, text.find_first_of(" \t\r\n"));
  if (library.empty()) return {};
  if (library.find('/') == std::string::npos) return found_by_name(library);
  return manifest.parent_path() / library;  // which is the library where that is absolute
}

std::string folder_identity(const fs::path& folder, std::string_view ending) {
  std::string text;
  for (const fs::path& file : files_in(folder)) {
    if (!file.string().ends_with(ending)) continue;
    text += file_identity(file);
    if (const fs::path library = library_named(file); !library.empty()) {
      text += file_identity(library);
    }
  }
  return text;
}

std::string library_identity(const void* function) {
  Dl_info info = {};
  if (dladdr(function, &info) == 0 || info.dli_fname == nullptr) return {};
  return file_identity(info.dli_fname);
}

std::string machine_identity() {
  return kernel() + file_identity("/etc/ld.so.cache") + device_files() + variables();
}

}  // namespace fathom::gpu
