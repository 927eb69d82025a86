// SPDX-License-Identifier: Apache-2.0
#include "tests/differential/pictures.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>

namespace fathom::differential {
namespace {

using test::SplitMix64;

/// Real grey values, before they are rounded and clamped.
class Canvas {
 public:
  Canvas(int width, int height, double largest, int n)
      : width_(width),
        height_(height),
        largest_(largest),
        n_(n),
        values_(static_cast<std::size_t>(width) * height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  double largest() const { return largest_; }
  int n() const { return n_; }

  template <class Grey>
  void add(Grey&& grey) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) at(x, y) += grey(x, y);
    }
  }
  double& at(int x, int y) { return values_[static_cast<std::size_t>(y) * width_ + x]; }

 private:
  int width_, height_;
  double largest_;
  int n_;
  std::vector<double> values_;
};

double unit(SplitMix64& random) { return random.below(1U << 24) / double(1U << 24); }

int side(SplitMix64& random, int length) {
  return static_cast<int>(random.below(static_cast<std::uint32_t>(length)));
}

/// From one grey level to all of the range, every octave as likely as the others.
double amplitude(SplitMix64& random, const Canvas& canvas) {
  return std::pow(canvas.largest(), unit(random));
}

/// Grey to stand on; often as bright as can be.
double ground(SplitMix64& random, const Canvas& canvas) {
  return std::floor(random.below(3) == 0 ? canvas.largest() - 1 : canvas.largest() * unit(random));
}

/// Half of the time across, down, or diagonal; else any direction.
std::pair<double, double> direction(SplitMix64& random) {
  const std::uint32_t choice = random.below(6);
  if (choice == 0) return {1, 0};
  if (choice == 1) return {0, 1};
  if (choice == 2) return {std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2};
  const double angle = 2 * std::numbers::pi * unit(random);
  return {std::cos(angle), std::sin(angle)};
}

void add_ramp(Canvas& canvas, SplitMix64& random) {
  const auto [across, down] = direction(random);
  const double slope = amplitude(random, canvas) / canvas.n();
  const double base = ground(random, canvas) / 2;
  canvas.add([&](int x, int y) { return base + slope * (across * x + down * y); });
}

/// A plane wave; whole periods a window half of the time, which leaves all other coefficients to
/// the rounding of the grey levels, and to ours.
void add_wave(Canvas& canvas, SplitMix64& random, double base) {
  double u, v;
  if (random.below(2) == 0) {
    u = side(random, canvas.n()) - canvas.n() / 2;
    v = random.below(4) == 0 ? 0 : side(random, canvas.n()) - canvas.n() / 2;
  } else {
    const auto [across, down] = direction(random);
    const double frequency = canvas.n() / 2 * unit(random);
    u = frequency * across;
    v = frequency * down;
  }
  const double height = amplitude(random, canvas) / 2, phase = 2 * std::numbers::pi * unit(random);
  canvas.add([&](int x, int y) {
    return base + height * std::cos(2 * std::numbers::pi * (u * x + v * y) / canvas.n() + phase);
  });
}

void add_waves(Canvas& canvas, SplitMix64& random) {
  const double base = ground(random, canvas);
  add_wave(canvas, random, base);
  for (std::uint32_t more = random.below(4); more > 0; --more) add_wave(canvas, random, 0);
}

/// Waves of whole periods, each rounded to grey levels before they are added: what rounding adds to
/// one are harmonics of its own, so that most coefficients stay empty to the last bit.
void add_stripes(Canvas& canvas, SplitMix64& random) {
  double room = canvas.largest();
  for (std::uint32_t waves = 1 + random.below(4); waves > 0; --waves) {
    const double height = std::min(amplitude(random, canvas), room) / 2;
    room -= 2 * height;
    // High frequencies are what makes so empty a spectrum score enough to be trusted.
    const int u = (random.below(3) == 0 ? 0 : side(random, canvas.n())) - canvas.n() / 2;
    const int v = random.below(3) == 0 ? 0 : side(random, canvas.n()) - canvas.n() / 2;
    const bool is_swapped = random.below(2) == 0;
    const double phase = 2 * std::numbers::pi * unit(random), base = height * unit(random) / 2;
    canvas.add([&](int x, int y) {
      const int turns = (is_swapped ? u * y + v * x : u * x + v * y) % canvas.n();
      return std::round(base + height +
                        height * std::cos(2 * std::numbers::pi * turns / canvas.n() + phase));
    });
  }
}

void add_spots(Canvas& canvas, SplitMix64& random) {
  for (std::uint32_t spots = 1 + random.below(4); spots > 0; --spots) {
    const double cx = side(random, canvas.width()), cy = side(random, canvas.height());
    const double height = amplitude(random, canvas);
    const double radius = 0.5 + canvas.n() / 2 * unit(random);
    canvas.add([&](int x, int y) {
      const double dx = x - cx, dy = y - cy;
      return height * std::exp(-(dx * dx + dy * dy) / (radius * radius));
    });
  }
}

void add_edge(Canvas& canvas, SplitMix64& random) {
  const double base = ground(random, canvas), step = amplitude(random, canvas);
  const bool across = random.below(2) == 0;
  const int where = side(random, std::min(across ? canvas.width() : canvas.height(), canvas.n()));
  // Once, or again in every window.
  const int period = random.below(2) == 0 ? canvas.n() : canvas.width() + canvas.height();
  canvas.add([&](int x, int y) {
    const int along = across ? x : y;
    return along % period < where ? base : base + step;
  });
}

void add_few_off(Canvas& canvas, SplitMix64& random) {
  const double base = ground(random, canvas);
  canvas.add([&](int, int) { return base; });
  // One or a few a window, whatever the frame.
  const double windows = double(canvas.width()) * canvas.height() / canvas.n() / canvas.n();
  const double count = 1 + windows * (1 + random.below(5));
  for (int i = 0; i < count; ++i) {
    canvas.at(side(random, canvas.width()), side(random, canvas.height())) +=
        random.below(2) == 0 ? 1 : -1;
  }
}

void add_sparse_noise(Canvas& canvas, SplitMix64& random) {
  const double base = random.below(2) == 0 ? 0 : ground(random, canvas);
  const double height = amplitude(random, canvas);
  const std::uint32_t rarity = 2U << random.below(10);
  canvas.add([&](int, int) { return base + (random.below(rarity) == 0 ? height : 0); });
}

void add_checkers(Canvas& canvas, SplitMix64& random) {
  const double base = ground(random, canvas) / 2, height = amplitude(random, canvas);
  const int cell = 1 << random.below(4);
  canvas.add([&](int x, int y) { return base + ((x / cell + y / cell) % 2 == 0 ? height : 0); });
}

/// A bright column or row near an edge of every window that lies at a multiple of its side, where
/// tapers are small.
void add_column(Canvas& canvas, SplitMix64& random) {
  const bool across = random.below(2) == 0;
  const int near = static_cast<int>(random.below(3));
  const int where = random.below(2) == 0 ? near : canvas.n() - 1 - near;
  const double height = amplitude(random, canvas);
  const double periods = random.below(3) * unit(random) * canvas.n() / 2;
  canvas.add([&](int x, int y) {
    if ((across ? x : y) % canvas.n() != where) return 0.0;
    const double angle = 2 * std::numbers::pi * periods * (across ? y : x) / canvas.n();
    return height * (1 + std::cos(angle)) / 2;
  });
}

using Artist = void (*)(Canvas&, SplitMix64&);

const std::map<std::string, Artist>& artists() {
  static const std::map<std::string, Artist> known = {
      {"slope", add_ramp},
      {"waves", add_waves},
      {"spots", add_spots},
      {"stripes", add_stripes},
      {"edge", add_edge},
      {"few-off", add_few_off},
      {"sparse-noise", add_sparse_noise},
      {"checkers", add_checkers},
      {"column", add_column},
      {"wave", [](Canvas& canvas, SplitMix64& random) {
         add_wave(canvas, random, ground(random, canvas));
       }}};
  return known;
}

void add_kind(const std::string& kind, int bits, Canvas& canvas, std::uint64_t seed) {
  const auto artist = artists().find(kind);
  if (artist != artists().end()) {
    SplitMix64 random(seed);
    return artist->second(canvas, random);
  }
  const test::Pixels pixels = test::make_pixels(kind, bits, canvas.width(), canvas.height(), seed);
  canvas.add([&](int x, int y) { return double{1} * pixels.at(x, y); });
}

}  // namespace

const std::vector<std::string>& picture_kinds() {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> all = test::contents();
    for (const auto& [name, artist] : artists()) all.push_back(name);
    return all;
  }();
  return kinds;
}

test::Pixels draw(const std::string& picture, int bits, int width, int height, std::uint64_t seed) {
  const std::size_t at = picture.find('@');
  int n = 0;
  if (at != std::string::npos) {
    std::from_chars(picture.data() + at + 1, picture.data() + picture.size(), n);
  }
  if (n < 1) throw std::invalid_argument("no @N in the picture " + picture);
  test::Pixels pixels{width, height, bits, {}};
  Canvas canvas(width, height, pixels.largest(), n);
  const std::string kinds = picture.substr(0, at);
  const std::size_t plus = kinds.find('+');
  add_kind(kinds.substr(0, plus), bits, canvas, seed);
  if (plus != std::string::npos) add_kind(kinds.substr(plus + 1), bits, canvas, seed + 1);
  pixels.values.resize(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double grey = std::clamp<double>(std::round(canvas.at(x, y)), 0, pixels.largest());
      pixels.at(x, y) = static_cast<std::uint16_t>(grey);
    }
  }
  return pixels;
}

}  // namespace fathom::differential
