// SPDX-License-Identifier: Apache-2.0
#include "engine/metric.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <vector>

#include "engine/error.hpp"
#include "engine/measure.hpp"
#include "engine/window.hpp"

namespace fathom {
namespace {

constexpr std::array kTransforms = {Transform::fft, Transform::walsh_paley,
                                    Transform::walsh_sequency, Transform::walsh_hadamard,
                                    Transform::dct};

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw Error(ErrorCode::bad_argument, fmt::format("metric \"{}\": {}", text, why));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc() || next != end) return std::nullopt;
  return value;
}

/// Shortest decimal that reads back as the same double.
std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

Transform parse_transform(std::string_view text, std::string_view name) {
  for (const Transform transform : kTransforms) {
    if (name == to_string(transform)) return transform;
  }
  refuse(text, fmt::format("no transform \"{}\"; there are fft, walsh-paley, walsh-sequency, "
                           "walsh-hadamard and dct",
                           name));
}

std::optional<Taper> parse_taper(std::string_view text, std::string_view part) {
  if (part == "none") return Taper::none();
  if (part == "hann") return Taper::hann();
  constexpr std::string_view key = "tukey=";
  if (!part.starts_with(key)) return std::nullopt;
  const auto fraction = number<double>(part.substr(key.size()));
  if (!fraction) refuse(text, fmt::format("\"{}\" needs a number, such as tukey=0.25", part));
  return Taper{*fraction};
}

std::optional<Band> parse_band(std::string_view text, std::string_view part) {
  constexpr std::string_view key = "band=";
  if (!part.starts_with(key)) return std::nullopt;
  const std::string_view range = part.substr(key.size());
  // The dash between the limits is the one that does not belong to an exponent (1e-3-0.25).
  for (std::size_t dash = range.find('-', 1); dash != std::string_view::npos;
       dash = range.find('-', dash + 1)) {
    const auto low = number<double>(range.substr(0, dash));
    const auto high = number<double>(range.substr(dash + 1));
    if (low && high) return Band{*low + 0.0, *high};  // -0 becomes 0: one value, one text
  }
  refuse(text, fmt::format("\"{}\" needs two frequencies in cycles per pixel, such as band=0-0.25",
                           part));
}

std::optional<int> parse_rings(std::string_view text, std::string_view part) {
  constexpr std::string_view key = "rings=";
  if (!part.starts_with(key)) return std::nullopt;
  const auto count = number<int>(part.substr(key.size()));
  if (!count) refuse(text, fmt::format("\"{}\" needs a whole number, such as rings=16", part));
  return count;
}

}  // namespace

const char* to_string(Transform transform) noexcept {
  switch (transform) {
    case Transform::fft:
      return "fft";
    case Transform::walsh_paley:
      return "walsh-paley";
    case Transform::walsh_sequency:
      return "walsh-sequency";
    case Transform::walsh_hadamard:
      return "walsh-hadamard";
    case Transform::dct:
      return "dct";
  }
  return "unknown";
}

const char* to_string(Measure measure) noexcept {
  switch (measure) {
    case Measure::moment:
      return "moment";
    case Measure::rings:
      return "rings";
    case Measure::entropy:
      return "entropy";
  }
  return "unknown";
}

std::optional<double> cycles_per_index(Transform transform) {
  switch (transform) {
    case Transform::fft:
      return 1;
    case Transform::walsh_sequency:
    case Transform::dct:
      return 0.5;
    case Transform::walsh_paley:
    case Transform::walsh_hadamard:
      return std::nullopt;
  }
  return std::nullopt;
}

std::string to_string(Taper taper) {
  if (taper == Taper::none()) return "none";
  if (taper == Taper::hann()) return "hann";
  return "tukey=" + shortest(taper.cosine_fraction);
}

namespace {

/// The highest index, either way from zero frequency.
int highest_index(TransformFamily family, int n) {
  switch (family) {
    case TransformFamily::fourier:
      return n / 2;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return n - 1;
  }
  return 0;
}

/// Whether any coefficient of the transform lies in the band.
bool holds_a_coefficient(const Band& band, Transform transform, int n) {
  const int most = highest_index(family_of(transform), n);
  for (int i = 0; i <= most; ++i) {
    for (int j = 0; j <= i; ++j) {
      if (band.contains(transform, n, static_cast<double>(i) * i + static_cast<double>(j) * j))
        return true;
    }
  }
  return false;
}

Taper usual_taper(TransformFamily family) {
  switch (family) {
    case TransformFamily::fourier:
      return Taper::hann();
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return Taper::none();
  }
  return Taper::none();
}

/// Whether a text names the taper even where there is none.
bool always_names_taper(TransformFamily family) { return usual_taper(family) != Taper::none(); }

/// The most rings of which every one holds a coefficient; 0 where not even two do.
int most_rings(MetricSpec spec) {
  for (spec.rings = kMostRings; spec.rings >= kFewestRings; --spec.rings) {
    if (Rings(spec).has_all()) return spec.rings;
  }
  return 0;
}

}  // namespace

bool Band::contains(Transform transform, int n, double squared_radius) const {
  const double window_lengths = n / cycles_per_index(transform).value_or(1);
  const double low_radius = low * window_lengths;
  const double high_radius = high * window_lengths;
  return low_radius * low_radius < squared_radius && squared_radius <= high_radius * high_radius;
}

MetricSpec MetricSpec::standard(Transform transform, int n) {
  return {.transform = transform, .n = n, .taper = usual_taper(family_of(transform))};
}

std::size_t MetricSpec::outputs() const {
  switch (measure) {
    case Measure::moment:
    case Measure::entropy:
      return 1;
    case Measure::rings:
      return static_cast<std::size_t>(rings);
  }
  return 0;
}

bool MetricSpec::subtracts_mean() const {
  if (taper == Taper::none()) return false;  // then the mean is in zero frequency alone
  switch (measure) {
    case Measure::moment:
    case Measure::entropy:
      return false;
    case Measure::rings:
      return family_of(transform) == TransformFamily::fourier;
  }
  return false;
}

bool MetricSpec::is_exact() const {
  return family_of(transform) == TransformFamily::walsh && taper == Taper::none() && !power;
}

bool MetricSpec::names_n(std::string_view text) {
  const auto parts = split(text, ':');
  return parts.size() > 1 && number<int>(parts[1]).has_value();
}

std::string MetricSpec::text() const {
  std::string text = fmt::format("{}:{}", to_string(transform), n);
  if (always_names_taper(family_of(transform)) || taper != Taper::none()) {
    text += ":" + to_string(taper);
  }
  if (power) text += ":power";
  if (measure == Measure::entropy) text += ":entropy";
  if (band) text += fmt::format(":band={}-{}", shortest(band->low), shortest(band->high));
  if (measure == Measure::rings) text += fmt::format(":rings={}", rings);
  return text;
}

namespace {

void require_frequencies(const MetricSpec& spec, std::string_view text, const char* what) {
  if (cycles_per_index(spec.transform)) return;
  refuse(text, fmt::format("{} has no frequency order, so no {}; use walsh-sequency, dct or fft",
                           to_string(spec.transform), what));
}

void require_band(const MetricSpec& spec, std::string_view text) {
  const Band& band = *spec.band;
  if (!(band.low >= 0 && band.low < band.high && band.high <= 1)) {
    refuse(text, "a band needs 0 <= LO < HI <= 1 cycles per pixel");
  }
  require_frequencies(spec, text, "band");
  if (!holds_a_coefficient(band, spec.transform, spec.n)) {
    refuse(text, fmt::format("none of the {0} x {0} coefficients lies in that band", spec.n));
  }
}

void require_rings(const MetricSpec& spec, std::string_view text) {
  if (spec.rings < kFewestRings || spec.rings > kMostRings) {
    refuse(text, fmt::format("there can be {} to {} rings", kFewestRings, kMostRings));
  }
  require_frequencies(spec, text, "rings");
  if (Rings(spec).has_all()) return;
  const int most = most_rings(spec);
  refuse(text,
         most == 0
             ? std::string("no coefficient lies in one of two rings; use a wider band")
             : fmt::format("a ring is without a coefficient; {} rings are the most here", most));
}

/// Which families can be weighed by a taper.
bool takes_taper(TransformFamily family) {
  switch (family) {
    case TransformFamily::fourier:
    case TransformFamily::walsh:
      return true;
    case TransformFamily::cosine:
      return false;
  }
  return false;
}

/// Which families' spectra are known to have an entropy that tells focus.
bool has_entropy(TransformFamily family) {
  switch (family) {
    case TransformFamily::cosine:
      return true;
    case TransformFamily::fourier:
    case TransformFamily::walsh:
      return false;
  }
  return false;
}

void require_taper(const MetricSpec& spec, std::string_view text) {
  // Written so that a NaN is refused too.
  if (!(spec.taper.cosine_fraction >= 0 && spec.taper.cosine_fraction <= 1)) {
    refuse(text, "the taper's fraction must be from 0 (none) to 1 (hann)");
  }
  if (spec.taper != Taper::none() && !takes_taper(family_of(spec.transform))) {
    refuse(text, fmt::format("{} takes no taper: it continues a window by its mirror images",
                             to_string(spec.transform)));
  }
}

void require_no_rings(const MetricSpec& spec, std::string_view text) {
  if (spec.rings != 0) refuse(text, fmt::format("a {} has no rings", to_string(spec.measure)));
}

void require_entropy(const MetricSpec& spec, std::string_view text) {
  require_no_rings(spec, text);
  if (!has_entropy(family_of(spec.transform))) {
    refuse(text, "only dct has an entropy, such as dct:64:entropy");
  }
  if (spec.power) refuse(text, "an entropy is of magnitudes: leave power out");
}

/// text: what the caller wrote, for messages.
void require_valid(const MetricSpec& spec, std::string_view text) {
  if (!is_window_side(spec.n)) {
    refuse(text, fmt::format("N = {} is not a power of two from {} to {}", spec.n, kSmallestWindow,
                             kLargestWindow));
  }
  require_taper(spec, text);
  if (spec.band) require_band(spec, text);
  switch (spec.measure) {
    case Measure::moment:
      return require_no_rings(spec, text);
    case Measure::rings:
      return require_rings(spec, text);
    case Measure::entropy:
      return require_entropy(spec, text);
  }
  refuse(text, "there is no such measure");
}

}  // namespace

void MetricSpec::validate() const { require_valid(*this, text()); }

MetricSpec MetricSpec::parse(std::string_view text, int n_if_omitted) {
  const auto parts = split(text, ':');
  MetricSpec spec = standard(parse_transform(text, parts[0]), n_if_omitted);
  std::size_t at = 1;
  if (names_n(text)) spec.n = *number<int>(parts[at++]);
  if (at < parts.size()) {
    if (const auto taper = parse_taper(text, parts[at])) {
      spec.taper = *taper;
      ++at;
    }
  }
  if (at < parts.size() && parts[at] == "power") {
    spec.power = true;
    ++at;
  }
  if (at < parts.size() && parts[at] == "entropy") {
    spec.measure = Measure::entropy;
    ++at;
  }
  if (at < parts.size()) {
    if (const auto band = parse_band(text, parts[at])) {
      spec.band = band;
      ++at;
    }
  }
  if (at < parts.size()) {
    const auto rings = parse_rings(text, parts[at]);
    if (rings && spec.measure == Measure::moment) {
      spec.measure = Measure::rings;
      spec.rings = *rings;
      ++at;
    }
  }
  if (at < parts.size()) {
    refuse(text, fmt::format("cannot read \"{}\" there; write TRANSFORM[:N][:TAPER][:power]"
                             "[:band=LO-HI][:rings=K], such as fft:64:hann:power:band=0-0.25, "
                             "or dct[:N]:entropy[:band=LO-HI]",
                             parts[at]));
  }
  require_valid(spec, text);
  return spec;
}

}  // namespace fathom
