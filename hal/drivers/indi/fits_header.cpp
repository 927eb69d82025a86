// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/fits_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "engine/error.hpp"

namespace fathom::indi {
namespace {

constexpr std::size_t kCard = 80;
constexpr std::size_t kKeyword = 8;
constexpr std::size_t kMostBlocks = 256;  // of a header: drivers write one or two
constexpr std::int64_t kLongestSide = 1'000'000;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::bad_data, "a picture of the INDI camera " + what);
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// KEYWORD = value / comment
struct Card {
  std::string_view keyword;
  std::string_view value;
};

/// The cards of a header, one after the other.
class Cards {
 public:
  explicit Cards(std::string_view file)
      : file_(file.substr(0, std::min(file.size(), kMostBlocks * kFitsBlock))) {}

  Card next() {
    if (file_.size() - at_ < kCard) refuse("has a FITS header without an end");
    const std::string_view card = file_.substr(at_, kCard);
    at_ += kCard;
    const std::string_view keyword = card.substr(0, kKeyword), rest = card.substr(kKeyword);
    const bool is_text =  // comments and names of people may hold anything
        std::all_of(keyword.begin(), keyword.end(), [](char c) { return c >= ' ' && c <= '~'; });
    if (!is_text) refuse("is no FITS, or its header is damaged");
    const bool has_value = rest.starts_with("= ");
    return {trimmed(keyword),
            has_value ? trimmed(rest.substr(2, rest.find('/') - 2)) : std::string_view()};
  }

  /// Bytes of the blocks that were begun.
  std::size_t blocks() const { return (at_ + kFitsBlock - 1) / kFitsBlock * kFitsBlock; }

 private:
  std::string_view file_;
  std::size_t at_ = 0;
};

/// A card that must be the next one.
std::string_view value_of(Cards& cards, std::string_view keyword) {
  const Card card = cards.next();
  if (card.keyword == keyword) return card.value;
  refuse(fmt::format("is no plain FITS: {} stands where {} should", card.keyword, keyword));
}

std::int64_t integer(std::string_view text, std::string_view keyword, std::int64_t highest) {
  std::int64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, number);
  if (problem == std::errc() && next == end && std::abs(number) <= highest) return number;
  refuse(fmt::format("has a FITS header with {} = {}", keyword, text));
}

/// FITS writes exponents with E or D, and signs before anything.
double real(std::string_view text, std::string_view keyword) {
  std::string plain(text.starts_with('+') ? text.substr(1) : text);
  std::replace(plain.begin(), plain.end(), 'D', 'E');
  double number = 0;
  const char* const end = plain.data() + plain.size();
  const auto [next, problem] = std::from_chars(plain.data(), end, number);
  if (problem == std::errc() && next == end && std::isfinite(number)) return number;
  refuse(fmt::format("has a FITS header with {} = {}", keyword, text));
}

void read_sides(Cards& cards, FitsHeader& header) {
  const std::int64_t axes = integer(value_of(cards, "NAXIS"), "NAXIS", 999);
  if (axes < 0 || axes > FitsHeader::kMostAxes) {
    refuse(fmt::format("has {} axes, where a picture has two or three", axes));
  }
  for (std::int64_t i = 1; i <= axes; ++i) {
    const std::string keyword = fmt::format("NAXIS{}", i);
    header.sides.push_back(integer(value_of(cards, keyword), keyword, kLongestSide));
    if (header.sides.back() < 0) refuse("has a side of a negative length");
  }
}

/// What follows the sides, in any order, up to the end.
void read_rest(Cards& cards, FitsHeader& header) {
  std::optional<double> zero, scale;
  for (Card card = cards.next(); card.keyword != "END"; card = cards.next()) {
    if (card.keyword == "BZERO" && !zero) zero = real(card.value, "BZERO");
    if (card.keyword == "BSCALE" && !scale) scale = real(card.value, "BSCALE");
    if (card.keyword == "GROUPS" && card.value == "T") refuse("is FITS of random groups");
  }
  header.zero = zero.value_or(0);
  header.scale = scale.value_or(1);
}

}  // namespace

std::string FitsHeader::text() const {
  std::string text;
  const auto add = [&text](const std::string& keyword, const std::string& value) {
    text += fmt::format("{:<80}", fmt::format("{:<8}= {:>20}", keyword, value));
  };
  add("SIMPLE", "T");
  add("BITPIX", fmt::format("{}", bits));
  add("NAXIS", fmt::format("{}", sides.size()));
  for (std::size_t i = 0; i < sides.size(); ++i) {
    add(fmt::format("NAXIS{}", i + 1), fmt::format("{}", sides[i]));
  }
  add("BZERO", fmt::format("{}", zero));
  add("BSCALE", fmt::format("{}", scale));
  text += fmt::format("{:<80}", "END");
  text.resize((text.size() + kFitsBlock - 1) / kFitsBlock * kFitsBlock, ' ');
  return text;
}

FitsHeader read_fits_header(std::span<const std::byte> file) {
  Cards cards({reinterpret_cast<const char*>(file.data()), file.size()});
  FitsHeader header;
  if (value_of(cards, "SIMPLE") != "T") refuse("is no standard FITS (SIMPLE is not T)");
  header.bits = static_cast<int>(integer(value_of(cards, "BITPIX"), "BITPIX", 64));
  const int known[] = {8, 16, 32, 64, -32, -64};
  if (std::find(std::begin(known), std::end(known), header.bits) == std::end(known)) {
    refuse(fmt::format("has a FITS header with BITPIX = {}", header.bits));
  }
  read_sides(cards, header);
  read_rest(cards, header);
  header.bytes = cards.blocks();
  return header;
}

}  // namespace fathom::indi
