// SPDX-License-Identifier: Apache-2.0
#include "mapping/output_folder.hpp"

#include <fmt/format.h>
#include <stdlib.h>  // mkdtemp

#include <cerrno>
#include <system_error>
#include <utility>

#include "engine/error.hpp"
#include "engine/file.hpp"

namespace fathom::mapping {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, std::error_code problem) {
  throw Error(ErrorCode::io, fmt::format("cannot write into the folder {}: {}", folder.string(),
                                         problem.message()));
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code problem;
  if (fs::exists(folder_, problem) && !fs::is_directory(folder_, problem)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} exists and is no folder; a map takes a folder of its own",
                            folder_.string()));
  }
  is_new_ = fs::create_directories(folder_, problem);
  if (problem) fail(folder_, problem);
  std::string name = (folder_ / ".fathom-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    const std::error_code reason(errno, std::generic_category());
    if (is_new_) fs::remove(folder_, problem);
    fail(folder_, reason);
  }
  hidden_ = name;
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(hidden_, ignored);
  if (is_new_) fs::remove(folder_, ignored);  // an empty one only
}

void OutputFolder::write(const std::string& name, std::string_view bytes) const {
  try {
    write_file(hidden_ / name, bytes);
  } catch (const Error& error) {  // nobody knows the hidden folder
    std::string words = error.what();
    const std::string hidden = hidden_.string();
    if (const auto at = words.find(hidden); at != std::string::npos)
      words.replace(at, hidden.size(), folder_.string());
    throw Error(error.code(), words);
  }
}

void OutputFolder::move_in() {
  std::error_code problem;
  for (const fs::directory_entry& entry : fs::directory_iterator(hidden_, problem)) {
    fs::rename(entry.path(), folder_ / entry.path().filename(), problem);
    if (problem) break;
  }
  if (problem) fail(folder_, problem);
  is_new_ = false;
}

}  // namespace fathom::mapping
