// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"

namespace fathom::replay {
namespace fs = std::filesystem;
namespace {

/// The ending in lower case, with its point.
std::string ending_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool is_picture_name(const fs::path& path) {
  constexpr std::array<std::string_view, 8> kEndings = {".png",  ".jpg", ".jpeg", ".tif",
                                                        ".tiff", ".pgm", ".ppm",  ".pnm"};
  return std::find(kEndings.begin(), kEndings.end(), ending_of(path)) != kEndings.end();
}

void add(const fs::path& path, Folder& folder) {
  if (const std::string kind = special_kind(path); !kind.empty()) {
    ++folder.skipped[kind];
  } else if (is_picture_name(path)) {
    folder.pictures.push_back(path.filename().string());
  } else {
    const std::string ending = ending_of(path);
    ++folder.skipped[ending.empty() ? "no ending" : ending.substr(1)];
  }
}

}  // namespace

Folder read_folder(const fs::path& path) {
  Folder folder;
  std::error_code problem;
  for (fs::directory_iterator it(path, problem), end; !problem && it != end;
       it.increment(problem)) {
    std::error_code ignored;
    const bool is_hidden = it->path().filename().string().front() == '.';
    if (!is_hidden && !it->is_directory(ignored)) add(it->path(), folder);
  }
  if (!problem) return folder;
  throw Error(ErrorCode::io, fmt::format("cannot read {}: {}", path.string(), problem.message()));
}

}  // namespace fathom::replay
