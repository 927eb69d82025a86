// SPDX-License-Identifier: Apache-2.0
// Picture files to frames, and frames to picture files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "../engine/frame.hpp"

namespace fathom {

/// Formats, told apart by the file's first bytes, never by its name.
enum class PictureFormat { png, jpeg, tiff, pgm };

/// Pictures wider or taller than this are refused: no focus camera makes them, but a damaged header does.
inline constexpr int kLargestPictureSide = 65536;
/// And so are pictures of more pixels than this (2^30).
inline constexpr std::size_t kMostPicturePixels = std::size_t{1} << 30;

/// How many pictures a file holds: the pages of a TIFF, 1 for everything else.
/// Throws Error(io) if it cannot be read, Error(bad_data) if it is empty, no picture or damaged.
std::size_t count_pages(const std::filesystem::path& path);

/// Reads one picture as grey: PNG, JPEG, TIFF, binary or ASCII PGM/PPM; 8-bit files give Depth::bits8, deeper ones
/// Depth::bits16 with the file's own values, not rescaled. Colour becomes grey by BT.601 luma,
/// 0.299 R + 0.587 G + 0.114 B rounded to nearest; an alpha channel is ignored.
/// page: 0-based. Throws as count_pages does, Error(out_of_bounds) for a page that is not there and
/// Error(bad_data) for a truncated or absurdly large picture or a pixel format that is no picture
/// (floating point, 32 bit).
Frame read_picture(const std::filesystem::path& path, std::size_t page = 0);

/// The same from the bytes of a file; `name` stands in error messages.
Frame read_picture(std::string_view bytes, std::string_view name, std::size_t page = 0);
std::size_t count_pages(std::string_view bytes, std::string_view name);

/// Writes a grey picture in the format that the file's ending names (.png, .tif, .tiff, .pgm), whole or not at all.
/// Throws Error(bad_argument) for another ending, Error(io) with the system's reason.
void write_picture(const std::filesystem::path& path, const Frame& frame);

}  // namespace fathom
