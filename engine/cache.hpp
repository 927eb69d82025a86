// SPDX-License-Identifier: Apache-2.0
// Files that make the next start faster and that nobody misses: compiled kernels, measured
// crossovers. One that is damaged, half written or of something else is as good as none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace fathom {

/// FNV-1a, 64 bits; `seed` to go on from another text's.
std::uint64_t hash_of(std::string_view bytes, std::uint64_t seed = 0xcbf29ce484222325);

/// $FATHOM_CACHE, else $XDG_CACHE_HOME/fathom, else $HOME/.cache/fathom: the first that is an
/// absolute path. Empty where there is none, or $FATHOM_CACHE is "none": then nothing is kept.
std::filesystem::path cache_folder();

/// What was kept under this name for this key (whatever it depends on: device, driver, version of a
/// kernel); nothing if that is not there or not whole. Never throws for a reason of the file's.
std::optional<std::string> read_cached(std::string_view name, std::string_view key);

/// While it lives, no other process has a lock of this name: what all of them would compute at once
/// the first one computes, and the others find it kept. Without a cache folder, and where the other
/// one takes longer than a minute, it is no lock; so nothing may depend on it but time.
class CacheLock {
 public:
  explicit CacheLock(std::string_view name);
  CacheLock(const CacheLock&) = delete;
  CacheLock& operator=(const CacheLock&) = delete;
  ~CacheLock();

 private:
  int file_ = -1;
};

/// Keeps bytes in the file cache_folder()/name, in place of what was there. Two processes may do so
/// at once: a reader sees one or the other. Answers whether it is kept; a folder that cannot be
/// written is no error.
bool write_cached(std::string_view name, std::string_view key, std::string_view bytes);

}  // namespace fathom
