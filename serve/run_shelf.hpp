// SPDX-License-Identifier: Apache-2.0
// The runs of a folder, by names that cannot lead out of it.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace fathom::serve {

/// Every function may be called from any thread.
class RunShelf {
 public:
  explicit RunShelf(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The newest ones as a JSON list, the newest first: id, kind, when, position, sigma, verdict,
  /// distance_mm, error. What cannot be read has an error and no more.
  std::string list();

  /// The bytes of a run file; nothing where there is none of that name.
  std::optional<std::string> file(const std::string& id) const;

  /// Computes it again: {"same":..,"text":..}. Nothing where there is none. Throws
  /// Error(bad_data) for one that cannot be computed.
  std::optional<std::string> rerun(const std::string& id) const;

 private:
  struct Known {
    std::filesystem::file_time_type changed;
    std::uintmax_t bytes = 0;
    std::string line;
  };
  std::string line_of(const std::filesystem::path& path);

  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, Known> known_;  // by id
};

}  // namespace fathom::serve
