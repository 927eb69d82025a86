// SPDX-License-Identifier: Apache-2.0
#include "pictures/tiff_file.hpp"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <new>

namespace fathom::pictures {
namespace {

TiffClient& client_of(thandle_t handle) { return *static_cast<TiffClient*>(handle); }

tmsize_t on_read(thandle_t handle, void* to, tmsize_t count) {
  TiffClient& client = client_of(handle);
  const std::size_t got = client.source->read(client.offset, to, static_cast<std::size_t>(count));
  client.offset += got;
  return static_cast<tmsize_t>(got);
}

tmsize_t on_write(thandle_t, void*, tmsize_t) { return 0; }

toff_t on_seek(thandle_t handle, toff_t offset, int whence) {
  TiffClient& client = client_of(handle);
  if (whence == SEEK_CUR) offset += client.offset;
  if (whence == SEEK_END) offset += client.source->size();
  return client.offset = offset;
}

toff_t on_size(thandle_t handle) { return client_of(handle).source->size(); }
int on_close(thandle_t) { return 0; }
int on_map(thandle_t, void**, toff_t*) { return 0; }
void on_unmap(thandle_t, void*, toff_t) {}

/// Returning 1 keeps libtiff from printing.
int on_error(TIFF*, void* handle, const char*, const char* format, va_list values) {
  TiffClient& client = client_of(handle);
  if (client.trouble[0] == '\0') {
    std::vsnprintf(client.trouble, sizeof client.trouble, format, values);
  }
  return 1;
}

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// Codecs warn where they make pixels up, and libtiff where it drops a damaged palette (and would
/// take its indices for grey levels) or finds a strip without bytes.
bool means_lost_pixels(std::string_view module, std::string_view text) {
  return module == "JPEGLib" || module == "PackBitsDecode" || has(text, "ColorMap") ||
         has(text, "Bogus \"StripByteCounts\"") || has(text, "Bogus \"TileByteCounts\"");
}

/// Odd tags that change no pixel; what is known of samples that are no colours is asked for.
bool is_harmless(std::string_view text) {
  constexpr std::array<std::string_view, 8> kHarmless = {
      "Unknown field with tag", "tags are not sorted",         "does not end in null",
      "contains null byte",     "Defining non-color channels", "Nonstandard tile",
      "ASCII value for tag",    "not terminated with EOI"};
  return std::any_of(kHarmless.begin(), kHarmless.end(),
                     [text](std::string_view part) { return has(text, part); });
}

/// Keeps a warning that a user should hear, once. No exception may pass through libtiff.
void keep_word(TiffClient& client, std::string_view text) {
  constexpr std::size_t kMost = 5;
  if (client.words.size() >= kMost) return;
  try {
    const std::string word(text.substr(0, text.find('\n')));
    if (std::find(client.words.begin(), client.words.end(), word) == client.words.end())
      client.words.push_back(word);
  } catch (const std::bad_alloc&) {  // then it is not heard
  }
}

int on_warning(TIFF* tiff, void* handle, const char* module, const char* format, va_list values) {
  char text[256];
  va_list again;
  va_copy(again, values);
  std::vsnprintf(text, sizeof text, format, again);
  va_end(again);
  if (means_lost_pixels(module != nullptr ? module : "", text)) {
    on_error(tiff, handle, module, format, values);
  } else if (!is_harmless(text)) {
    keep_word(client_of(handle), text);
  }
  return 1;
}

}  // namespace

TiffFile::TiffFile(const Source& source) {
  client_.source = &source;
  struct Options {
    TIFFOpenOptions* raw = TIFFOpenOptionsAlloc();
    ~Options() { TIFFOpenOptionsFree(raw); }
  } options;
  if (options.raw == nullptr) throw std::bad_alloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options.raw, on_error, &client_);
  TIFFOpenOptionsSetWarningHandlerExtR(options.raw, on_warning, &client_);
  // libtiff's own buffers hold packed data and tables, never more than the file does.
  const std::uint64_t most = std::min<std::uint64_t>(source.size(), std::uint64_t{1} << 40);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.raw, static_cast<tmsize_t>(4 * most + (1 << 24)));
  tiff_.reset(TIFFClientOpenExt(source.name().c_str(), "rm", &client_, on_read, on_write, on_seek,
                                on_close, on_size, on_map, on_unmap, options.raw));
  if (tiff_ == nullptr) throw_damaged(name(), reason());
}

bool TiffFile::select(std::uint64_t directory) {
  forget_trouble();
  return TIFFSetSubDirectory(get(), directory) != 0 && !in_trouble();
}

std::string_view TiffFile::reason() const {
  std::string_view text = client_.trouble;
  if (text.starts_with(name() + ": ")) text.remove_prefix(name().size() + 2);
  return text.empty() ? "libtiff gives no reason" : text;
}

std::uint32_t TiffFile::field(std::uint32_t tag) const {
  std::uint16_t value = 0;
  TIFFGetFieldDefaulted(get(), tag, &value);
  return value;
}

}  // namespace fathom::pictures
