// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/names.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>

namespace fathom::replay {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes the digits at the front of a text; returns them without leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

/// How a name is read.
struct Reading {
  bool decimals = false;   // 0.5 is one number
  bool all_signs = false;  // a minus before digits is a sign wherever it stands
};

/// One number of a name, exact however many digits it has.
struct Number {
  bool is_negative = false;
  std::string whole, fraction;  // digits, without zeros that say nothing
  std::string exponent;         // "-05", or empty

  double value() const {
    const std::string text = (is_negative ? "-" : "") + (whole.empty() ? "0" : whole) + "." +
                             (fraction.empty() ? "0" : fraction) +
                             (exponent.empty() ? "" : "e" + exponent);
    return std::strtod(text.c_str(), nullptr);
  }
  bool is_zero() const { return whole.empty() && fraction.empty(); }
};

int compare(std::string_view a, std::string_view b) {
  const int order = a.compare(b);
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

/// -1, 0 or 1.
int compare(const Number& a, const Number& b) {
  if (!a.exponent.empty() || !b.exponent.empty()) {
    const double x = a.value(), y = b.value();
    return x < y ? -1 : x > y ? 1 : 0;
  }
  const bool down_a = a.is_negative && !a.is_zero();
  const bool down_b = b.is_negative && !b.is_zero();
  if (down_a != down_b) return down_a ? -1 : 1;
  const int sign = down_a ? -1 : 1;
  if (a.whole.size() != b.whole.size()) return a.whole.size() < b.whole.size() ? -sign : sign;
  if (const int order = compare(a.whole, b.whole)) return sign * order;
  return sign * compare(a.fraction, b.fraction);
}

/// A name cut into numbers and what stands between them.
struct Parts {
  std::string text;  // of the name, with a mark where a number stood
  std::vector<Number> numbers;
};

class NameReader {
 public:
  NameReader(std::string_view stem, Reading reading) : stem_(stem), reading_(reading) {}

  Parts read() {
    while (at_ < stem_.size()) {
      const bool is_sign = (stem_[at_] == '-' || stem_[at_] == '+') && digit_at(at_ + 1) &&
                           (reading_.all_signs || stands_apart());
      if (is_sign || digit_at(at_)) {
        number(is_sign);
      } else {
        parts_.text += stem_[at_++];
      }
    }
    return std::move(parts_);
  }

 private:
  bool digit_at(std::size_t at) const { return at < stem_.size() && is_digit(stem_[at]); }
  bool point_at(std::size_t at) const {
    return at < stem_.size() && (stem_[at] == '.' || stem_[at] == ',');
  }

  /// A minus that another separator precedes separates nothing.
  bool stands_apart() const {
    return at_ == 0 || std::string_view("_= ([").find(stem_[at_ - 1]) != std::string_view::npos;
  }

  std::string_view digits() {
    const std::size_t start = at_;
    while (digit_at(at_)) ++at_;
    return stem_.substr(start, at_ - start);
  }

  void number(bool has_sign) {
    Number number;
    if (has_sign) number.is_negative = stem_[at_++] == '-';
    std::string_view rest = digits();
    number.whole = take_number(rest);
    if (reading_.decimals && point_at(at_) && digit_at(at_ + 1)) {
      ++at_;
      std::string_view fraction = digits();
      fraction = fraction.substr(0, fraction.find_last_not_of('0') + 1);
      number.fraction = fraction;
    }
    if (reading_.decimals) number.exponent = exponent();
    parts_.text += '\0';
    parts_.numbers.push_back(std::move(number));
  }

  /// Only with its sign, as programs write it: e5 may be anything.
  std::string exponent() {
    const bool is_there = at_ + 2 < stem_.size() && (stem_[at_] == 'e' || stem_[at_] == 'E') &&
                          (stem_[at_ + 1] == '-' || stem_[at_ + 1] == '+') && digit_at(at_ + 2);
    if (!is_there) return {};
    const std::size_t sign = ++at_;
    ++at_;
    digits();
    return std::string(stem_.substr(sign, at_ - sign));
  }

  std::string_view stem_;
  Reading reading_;
  std::size_t at_ = 0;
  Parts parts_;
};

/// The name without its ending, whose point is no decimal one.
std::string_view stem_of(std::string_view name) { return name.substr(0, name.rfind('.')); }

/// Digits behind a point between digits, in any of the names, that end in a zero as no number that
/// a program prints does; a lone 0 is one ("2.0").
bool has_counting_fractions(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string_view stem = stem_of(name);
    for (std::size_t i = 1; i + 1 < stem.size(); ++i) {
      if (stem[i] != '.' || !is_digit(stem[i - 1]) || !is_digit(stem[i + 1])) continue;
      std::size_t end = i + 1;
      while (end < stem.size() && is_digit(stem[end])) ++end;
      if (end - i > 2 && stem[end - 1] == '0') return true;
    }
  }
  return false;
}

/// Whether fractions have one length, so that a zero at their end says nothing ("0.50").
bool fractions_are_alike(const std::vector<std::string>& names) {
  std::optional<std::size_t> length;
  for (const std::string& name : names) {
    const std::string_view stem = stem_of(name);
    const std::size_t point = stem.rfind('.');
    if (point == std::string_view::npos) return false;
    std::size_t end = point + 1;
    while (end < stem.size() && is_digit(stem[end])) ++end;
    if (!length) length = end - point;
    if (*length != end - point) return false;
  }
  return true;
}

/// Names read in one way.
struct ReadNames {
  std::vector<Parts> parts;
  std::size_t kinds = 0;    // how many texts there are round the numbers
  std::size_t largest = 0;  // how many names share the commonest of them
};

ReadNames read_as(const std::vector<std::string>& names, Reading reading) {
  ReadNames result;
  std::map<std::string, std::size_t> kinds;
  for (const std::string& name : names) {
    result.parts.push_back(NameReader(stem_of(name), reading).read());
    const Parts& parts = result.parts.back();
    const std::size_t count = ++kinds[parts.text];
    if (!parts.numbers.empty()) result.largest = std::max(result.largest, count);
  }
  result.kinds = kinds.size();
  return result;
}

/// The reading by which most names share one text, the plainest of several; nothing where hardly
/// any do.
std::optional<ReadNames> read_names(const std::vector<std::string>& names) {
  const bool decimals = !has_counting_fractions(names) || fractions_are_alike(names);
  std::optional<ReadNames> best;
  for (const bool all_signs : {false, true}) {
    for (const bool points : {decimals, !decimals}) {
      ReadNames read = read_as(names, {points, all_signs});
      if (!best || read.largest > best->largest) best = std::move(read);
    }
  }
  const bool are_alike = 4 * best->largest >= 3 * names.size();  // a stray picture or two
  return are_alike ? best : std::nullopt;
}

/// The one number in which names differ; nothing where it is more than one.
std::optional<std::size_t> varying_number(const std::vector<Parts>& parts) {
  std::optional<std::size_t> varying;
  for (std::size_t i = 0; i < parts.front().numbers.size(); ++i) {
    const bool is_constant = std::all_of(parts.begin(), parts.end(), [&](const Parts& one) {
      return compare(one.numbers[i], parts.front().numbers[i]) == 0;
    });
    if (is_constant) continue;
    if (varying) return std::nullopt;
    varying = i;
  }
  return varying;
}

/// Numbers left out of a row of even steps. A travel of uneven steps has none.
std::optional<MissingNumbers> gap_of(const std::vector<Parts>& parts,
                                     const std::vector<std::string>& names,
                                     const std::vector<std::size_t>& order) {
  const auto column = varying_number(parts);
  if (!column || order.size() < 4) return std::nullopt;
  std::vector<double> steps;
  for (std::size_t i = 1; i < order.size(); ++i) {
    steps.push_back(parts[order[i]].numbers[*column].value() -
                    parts[order[i - 1]].numbers[*column].value());
  }
  const double step = *std::min_element(steps.begin(), steps.end());
  if (!(step > 0)) return std::nullopt;
  MissingNumbers gap;
  std::size_t even = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double times = std::round(steps[i] / step);
    if (std::abs(steps[i] / step - times) > 1e-3 * times) return std::nullopt;
    if (times == 1) ++even;
    if (times == 1) continue;
    if (gap.count == 0) gap.before = names[order[i]], gap.after = names[order[i + 1]];
    gap.count += static_cast<std::size_t>(times) - 1;
  }
  const bool is_a_row = 2 * even > steps.size() && gap.count > 0;
  return is_a_row ? std::optional(gap) : std::nullopt;
}

/// Neighbours that differ in their endings alone.
std::optional<NamesTwice> names_twice(const std::vector<std::string>& names,
                                      const std::vector<std::size_t>& order) {
  NamesTwice twice;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::string &before = names[order[i - 1]], &name = names[order[i]];
    if (stem_of(before) != stem_of(name)) continue;
    if (twice.count++ == 0) twice.first = before, twice.second = name;
  }
  return twice.count > 0 ? std::optional(twice) : std::nullopt;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = take_number(a);
      const std::string_view number_b = take_number(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a.front() != b.front()) {
        return static_cast<unsigned char>(a.front()) < static_cast<unsigned char>(b.front());
      }
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // x_01 and x_1 differ by zeros only
}

OrderedNames order_of(const std::vector<std::string>& names) {
  OrderedNames result;
  result.order.resize(names.size());
  std::iota(result.order.begin(), result.order.end(), std::size_t{0});
  if (names.empty()) return result;
  const auto read = read_names(names);
  std::sort(result.order.begin(), result.order.end(), [&](std::size_t a, std::size_t b) {
    if (!read) return natural_less(names[a], names[b]);
    const Parts &one = read->parts[a], &other = read->parts[b];
    if (const int order = compare(one.text, other.text)) return order < 0;
    for (std::size_t i = 0; i < one.numbers.size(); ++i) {
      if (const int order = compare(one.numbers[i], other.numbers[i])) return order < 0;
    }
    return natural_less(names[a], names[b]);
  });
  result.twice = names_twice(names, result.order);
  if (!read) return result;
  result.by_numbers = true;
  if (read->kinds == 1) result.gap = gap_of(read->parts, names, result.order);
  return result;
}

}  // namespace fathom::replay
