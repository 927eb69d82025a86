// SPDX-License-Identifier: Apache-2.0
#include "tests/differential/case.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <stdexcept>

#include "engine/error.hpp"
#include "tests/differential/pictures.hpp"

namespace fathom::differential {
namespace {

using test::SplitMix64;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

int below(SplitMix64& random, std::size_t limit) {
  return static_cast<int>(random.below(static_cast<std::uint32_t>(limit)));
}

template <class T>
const T& any_of(SplitMix64& random, const std::vector<T>& choice) {
  return choice[below(random, choice.size())];
}

Taper random_taper(SplitMix64& random) {
  switch (random.below(4)) {
    case 0:
      return Taper::none();
    case 1:
      return {(1 + random.below(999)) / 1000.0};
    default:
      return Taper::hann();
  }
}

/// Of one that the transform takes; half of the Walsh ones have none.
Taper random_taper_of(TransformFamily family, SplitMix64& random) {
  switch (family) {
    case TransformFamily::fourier:
      return random_taper(random);
    case TransformFamily::walsh:
      return random.below(2) == 0 ? Taper::none() : random_taper(random);
    case TransformFamily::cosine:
      break;
  }
  return Taper::none();
}

Band random_band(SplitMix64& random) {
  const double low = random.below(2) == 0 ? 0 : random.below(700) / 1000.0;
  const double most = 1 - low;
  return {low, low + most * (1 + random.below(1000)) / 1000.0};
}

bool holds_nothing(const MetricSpec& spec) {
  try {
    spec.validate();
    return false;
  } catch (const Error&) {
    return true;
  }
}

/// As many rings as the band allows, or fewer; none where there is no room for two.
void add_rings(MetricSpec& spec, SplitMix64& random) {
  const MetricSpec without = spec;
  spec.measure = Measure::rings;
  spec.rings = kFewestRings + below(random, kMostRings - kFewestRings + 1);
  while (spec.rings >= kFewestRings && holds_nothing(spec)) --spec.rings;
  if (spec.rings < kFewestRings) spec = without;
}

void make_entropy(MetricSpec& spec) {
  spec.measure = Measure::entropy;
  spec.rings = 0;
  spec.power = false;
}

MetricSpec random_spec(SplitMix64& random, const Choice& choice) {
  MetricSpec spec = MetricSpec::parse(any_of(random, choice.transforms));
  // The lesser of two, because large windows take their time.
  const int first = below(random, choice.sides.size()), second = below(random, choice.sides.size());
  spec.n = choice.sides[std::min(first, second)];
  spec.taper = random_taper_of(family_of(spec.transform), random);
  spec.power = random.below(4) == 0;
  const bool has_frequencies = cycles_per_index(spec.transform).has_value();
  if (has_frequencies && random.below(4) == 0) {
    do {
      spec.band = random_band(random);
    } while (holds_nothing(spec));
  }
  if (has_frequencies && random.below(3) == 0) add_rings(spec, random);
  if (spec.transform == Transform::dct && random.below(2) == 0) make_entropy(spec);
  spec.validate();
  return spec;
}

std::string random_picture(SplitMix64& random, const Choice& choice, int n) {
  const auto& kinds = choice.pictures.empty() ? picture_kinds() : choice.pictures;
  std::string picture = any_of(random, kinds);
  if (random.below(2) == 0) picture += "+" + any_of(random, kinds);
  return fmt::format("{}@{}", picture, n);
}

/// Anywhere, at the frame's edges, or at multiples of the side, where draw() places things.
int random_place(SplitMix64& random, int length, int n) {
  const int last = length - n;
  switch (random.below(4)) {
    case 0:
      return random.below(2) == 0 ? 0 : last;
    case 1:
      return below(random, last / n + 1) * n;
    default:
      return below(random, last + 1);
  }
}

int number(const std::string& text) {
  std::size_t end = 0;
  const int value = std::stoi(text, &end);
  if (end != text.size()) throw std::invalid_argument("no number: " + text);
  return value;
}

std::string after(const std::string& name, const std::string& text) {
  if (!text.starts_with(name)) throw std::invalid_argument("no " + name + " in " + text);
  return text.substr(name.size());
}

void require_sense(const Case& tested) {
  const auto& crop = tested.crop;
  bool is_sound = (tested.bits == 8 || tested.bits == 16) && crop.x >= 0 && crop.y >= 0 &&
                  crop.width > 0 && crop.height > 0 && crop.x + crop.width <= tested.width &&
                  crop.y + crop.height <= tested.height && tested.gap >= 0;
  for (const Window& window : tested.windows) {
    is_sound = is_sound && fits(window, crop.width, crop.height);
  }
  if (!is_sound) throw std::invalid_argument("windows or crop outside, or bits not 8 or 16");
}

}  // namespace

std::string Case::text() const {
  std::vector<std::string> places;
  for (const Window& window : windows) places.push_back(fmt::format("{},{}", window.x, window.y));
  return fmt::format("{}/{}/{}/{}x{}/seed={}/crop={},{},{},{}/gap={}/windows={}", spec.text(),
                     picture, bits, width, height, seed, crop.x, crop.y, crop.width, crop.height,
                     gap, fmt::join(places, ";"));
}

Case Case::parse(const std::string& text) {
  const auto parts = split(text, '/');
  if (parts.size() != 8) throw std::invalid_argument("a case has eight parts: " + text);
  Case read;
  read.spec = MetricSpec::parse(parts[0]);
  read.picture = parts[1];
  read.bits = number(parts[2]);
  const auto sides = split(parts[3], 'x');
  const auto crop = split(after("crop=", parts[5]), ',');
  if (sides.size() != 2 || crop.size() != 4) throw std::invalid_argument("sizes: " + text);
  read.width = number(sides[0]);
  read.height = number(sides[1]);
  read.seed = std::stoull(after("seed=", parts[4]));
  read.crop = {number(crop[0]), number(crop[1]), number(crop[2]), number(crop[3])};
  read.gap = number(after("gap=", parts[6]));
  for (const std::string& place : split(after("windows=", parts[7]), ';')) {
    const auto at = split(place, ',');
    if (at.size() != 2) throw std::invalid_argument("a window is X,Y: " + place);
    read.windows.push_back({number(at[0]), number(at[1]), read.spec.n});
  }
  require_sense(read);
  return read;
}

test::Pixels Case::pixels() const {
  const test::Pixels all = draw(picture, bits, width, height, seed);
  test::Pixels part{crop.width, crop.height, bits, {}};
  part.values.resize(static_cast<std::size_t>(crop.width) * crop.height);
  for (int y = 0; y < crop.height; ++y) {
    for (int x = 0; x < crop.width; ++x) part.at(x, y) = all.at(crop.x + x, crop.y + y);
  }
  return part;
}

Case random_case(std::uint64_t seed, const Choice& choice) {
  SplitMix64 random(seed);
  Case drawn;
  drawn.spec = random_spec(random, choice);
  const int n = drawn.spec.n;
  drawn.picture = random_picture(random, choice, n);
  drawn.bits = any_of(random, choice.bits);
  const int room = n <= 64 ? 3 * n : n / 2;
  drawn.width = n + below(random, room + 1);
  drawn.height = n + below(random, room + 1);
  drawn.seed = random.next();
  drawn.crop = {0, 0, drawn.width, drawn.height};
  drawn.gap = random.below(3) == 0 ? 0 : below(random, 100);
  // The larger the window, the fewer: a round is to take about as long whatever its metric.
  const std::size_t most = std::min<std::size_t>(choice.windows, n <= 32 ? 300 : 300 * 32 / n);
  const int count = 1 + below(random, random.below(3) == 0 ? std::min<std::size_t>(most, 5) : most);
  while (static_cast<int>(drawn.windows.size()) < count) {
    const int x = random_place(random, drawn.width, n);
    drawn.windows.push_back({x, random_place(random, drawn.height, n), n});
  }
  return drawn;
}

}  // namespace fathom::differential
