// SPDX-License-Identifier: Apache-2.0
// A TIFF opened by libtiff from a Source, with ears for what libtiff says.
#pragma once

#include <tiffio.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pictures/decoder.hpp"

namespace fathom::pictures {

/// What libtiff's callbacks are given: the file, where it reads, and what was said.
struct TiffClient {
  const Source* source = nullptr;
  std::uint64_t offset = 0;
  char trouble[300] = "";          // the first error, or a warning that means lost pixels
  std::vector<std::string> words;  // other warnings, each once
};

class TiffFile {
 public:
  /// Throws Error(bad_data) for what libtiff cannot open. The source outlives this.
  explicit TiffFile(const Source& source);

  TIFF* get() const { return tiff_.get(); }
  const Source& source() const { return *client_.source; }
  const std::string& name() const { return client_.source->name(); }

  /// Reads a directory, also where it is the current one: what libtiff says of it counts. False
  /// where it is damaged; reason() tells.
  bool select(std::uint64_t directory);

  /// Whether libtiff found an error, or lost pixels, since forget_trouble().
  bool in_trouble() const { return client_.trouble[0] != '\0'; }
  void forget_trouble() { client_.trouble[0] = '\0'; }
  /// Its word on what went wrong, without the file's name, which our own messages start with.
  std::string_view reason() const;

  /// The other warnings so far.
  const std::vector<std::string>& words() const { return client_.words; }

  /// A field of the current directory that is one 16-bit number, or its default.
  std::uint32_t field(std::uint32_t tag) const;

 private:
  struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  };

  TiffClient client_;
  std::unique_ptr<TIFF, Close> tiff_;
};

}  // namespace fathom::pictures
