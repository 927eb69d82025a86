// SPDX-License-Identifier: Apache-2.0
// Writes the golden values, or checks that the small ones of a file are still what it would write:
//
//   make_golden > tests/golden/golden.txt              (some minutes: N = 512 in 113-bit
//   arithmetic) make_golden --check tests/golden/golden.txt 32     (N up to 32: a moment; ctest
//   runs it)
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "tests/golden/direct_sums.hpp"

namespace fathom::golden {
namespace {

using test::Pixels;

struct Picture {
  std::string content;
  int bits;
  bool operator==(const Picture&) const = default;
};

constexpr std::uint64_t kSeed = 19891215;

/// One way to weigh a spectrum: what follows the taper in a metric's text.
struct Weighing {
  bool power = false;
  std::string low, high;  // cycles per pixel; no band if empty
  int rings = 0;          // the moment if 0

  std::string text() const {
    return std::string(power ? ":power" : "") + (low.empty() ? "" : ":band=" + low + "-" + high) +
           (rings == 0 ? "" : ":rings=" + std::to_string(rings));
  }
  /// (LO + (HI - LO) k / K) N in double and in that order, squared.
  std::vector<double> squared_edges(int n) const {
    const double lowest = low.empty() ? 0 : std::stod(low);
    const double highest = high.empty() ? 0.5 : std::stod(high);
    std::vector<double> squares;
    for (int k = 0; k <= rings; ++k) {
      const double edge = (lowest + (highest - lowest) * k / rings) * n;
      squares.push_back(edge * edge);
    }
    return squares;
  }
  /// cycles: how many indices make one cycle per window, 1 for fft and 2 for sequency.
  Options options(int n, int cycles) const {
    if (low.empty()) return {power, std::nullopt};
    const auto squared_radius = [&](const std::string& limit) {
      const Quad radius = strtoflt128(limit.c_str(), nullptr) * n * cycles;
      return radius * radius;
    };
    return {power, std::pair(squared_radius(low), squared_radius(high))};
  }
};

const Weighing kPlain{}, kPower{true, "", ""}, kLowBand{false, "0", "0.25"},
    kMidBand{false, "0.1", "0.25"}, kPowerBand{true, "0.05", "0.2"};

/// As many rings as a window has, and what else rings can be told.
std::vector<Weighing> ring_weighings(int n) {
  return {{false, "", "", n == 8 ? 4 : 8}, {true, "", "", 3}, {true, "0.125", "0.4", 2}};
}

struct Order {
  const char* name;
  WalshOrder order;
};
const std::vector<Order> kOrders = {{"walsh-paley", WalshOrder::paley},
                                    {"walsh-sequency", WalshOrder::sequency},
                                    {"walsh-hadamard", WalshOrder::hadamard}};

std::vector<Picture> every_picture() {
  std::vector<Picture> pictures;
  for (const std::string& content : test::contents()) {
    for (const int bits : {8, 16}) pictures.push_back({content, bits});
  }
  return pictures;
}

/// Collects the lines of one window size.
class Sheet {
 public:
  explicit Sheet(int n) : n_(n) {}

  void fourier(const std::string& taper_name, const Picture& picture,
               const std::vector<Weighing>& weighings) {
    const auto power = fourier_power(draw(picture), taper(fraction(taper_name), n_));
    for (const Weighing& weighing : weighings) {
      add("fft", ":" + taper_name + weighing.text(), picture,
          fourier_quality(power, weighing.options(n_, 1)));
    }
  }

  void walsh(const Order& order, const Picture& picture, const std::vector<Weighing>& weighings) {
    const auto sums = walsh_sums(draw(picture), functions(order));
    for (const Weighing& weighing : weighings) {
      const std::uint64_t moment = walsh_moment(sums, weighing.options(n_, 2));
      const Quad n = n_;
      add(order.name, weighing.text(), picture, moment / (n * n * n * n * n * n), moment);
    }
  }

  void tapered(const Order& order, const std::string& taper_name, const Picture& picture,
               const std::vector<Weighing>& weighings) {
    const auto spectrum =
        tapered_walsh(draw(picture), taper(fraction(taper_name), n_), functions(order));
    const std::string taper_text = taper_name == "none" ? "" : ":" + taper_name;
    for (const Weighing& weighing : weighings) {
      add(order.name, taper_text + weighing.text(), picture,
          real_quality(spectrum, weighing.options(n_, 2)));
    }
  }

  void cosine(const Picture& picture, const std::vector<Weighing>& weighings) {
    const auto spectrum = cosine_spectrum(draw(picture));
    for (const Weighing& weighing : weighings) {
      const Options options = weighing.options(n_, 2);
      add("dct", weighing.text(), picture, real_quality(spectrum, options));
      if (weighing.power) continue;
      add("dct", ":entropy" + weighing.text(), picture, entropy(spectrum, options));
    }
  }

  /// Under a taper the weighted mean goes before it.
  void fourier_rings(const std::string& taper_name, const Picture& picture) {
    const auto w = taper(fraction(taper_name), n_);
    const Pixels pixels = draw(picture);
    const Quad mean = taper_name == "none" ? Quad(0) : weighted_mean(pixels, w);
    const auto powers = fourier_power(pixels, w, mean);
    for (const Weighing& weighing : ring_weighings(n_)) {
      const auto masses = weighing.power ? powers : roots_of(powers);
      add("fft", ":" + taper_name + weighing.text(), picture,
          ring_means(masses, weighing.squared_edges(n_), n_ / 2, 1));
    }
  }

  void cosine_rings(const Picture& picture) {
    real_rings("dct", "", picture, cosine_spectrum(draw(picture)));
  }

  void sequency_rings(const std::string& taper_name, const Picture& picture) {
    const auto spectrum =
        tapered_walsh(draw(picture), taper(fraction(taper_name), n_), functions(kOrders[1]));
    real_rings(kOrders[1].name, taper_name == "none" ? "" : ":" + taper_name, picture, spectrum);
  }

  void real_rings(const std::string& transform, const std::string& taper_text,
                  const Picture& picture, const Square<Quad>& spectrum) {
    for (const Weighing& weighing : ring_weighings(n_)) {
      Square<Quad> masses = spectrum;
      for (int i = 0; i < n_; ++i) {
        for (int j = 0; j < n_; ++j) {
          const Quad w = spectrum.at(i, j);
          masses.at(i, j) = weighing.power ? w * w : fabsq(w);
        }
      }
      add(transform, taper_text + weighing.text(), picture,
          ring_means(masses, weighing.squared_edges(n_), 0, 2));
    }
  }

  const std::vector<std::string>& lines() const { return lines_; }

 private:
  Pixels draw(const Picture& picture) const {
    return test::make_pixels(picture.content, picture.bits, n_, n_, kSeed);
  }

  Square<int> functions(const Order& order) const { return walsh_functions(order.order, n_); }

  Square<Quad> roots_of(const Square<Quad>& squares) const {
    Square<Quad> roots(n_);
    for (int row = 0; row < n_; ++row) {
      for (int col = 0; col < n_; ++col) roots.at(row, col) = sqrtq(squares.at(row, col));
    }
    return roots;
  }

  static Quad fraction(const std::string& taper_name) {
    if (taper_name == "none") return 0;
    if (taper_name == "hann") return 1;
    return strtoflt128(taper_name.c_str() + std::string("tukey=").size(), nullptr);
  }

  void add(const std::string& transform, const std::string& options, const Picture& picture,
           Quad score, std::optional<std::uint64_t> sum = std::nullopt) {
    add(transform, options, picture, std::vector{score});
    if (sum) lines_.back() += " " + std::to_string(*sum);
  }

  void add(const std::string& transform, const std::string& options, const Picture& picture,
           const std::vector<Quad>& values) {
    std::string texts;
    for (Quad value : values) {
      // What 113-bit rounding leaves of sums that cancel; real scores are far larger.
      if (fabsq(value) < Quad(1e-25)) value = 0;
      char text[64];
      std::snprintf(text, sizeof text, "%a", static_cast<double>(value));
      texts += (texts.empty() ? "" : ",") + std::string(text);
    }
    lines_.push_back(transform + ":" + std::to_string(n_) + options + " " + picture.content + " " +
                     std::to_string(picture.bits) + " " + std::to_string(kSeed) + " " + texts);
  }

  int n_;
  std::vector<std::string> lines_;
};

const Picture kRandom8{"random", 8}, kNatural16{"natural", 16};

/// Everything, where it costs nothing.
void fill_small(Sheet& sheet) {
  const std::vector<Weighing> all = {kPlain, kPower, kLowBand, kMidBand, kPowerBand};
  for (const Picture& picture : every_picture()) {
    const bool typical = picture == kRandom8 || picture == kNatural16;
    sheet.fourier("hann", picture, typical ? all : std::vector{kPlain});
  }
  sheet.fourier("hann", {"flat", 8}, {kMidBand});
  for (const char* taper_name : {"none", "tukey=0.25"}) {
    for (const Picture& picture : {kRandom8, kNatural16}) sheet.fourier(taper_name, picture, all);
  }
  for (const char* content : {"flat", "full", "impulse", "checkerboard"}) {
    sheet.fourier("none", {content, 16}, {kPlain});
  }
  for (const Order& order : kOrders) {
    for (const Picture& picture : every_picture()) sheet.walsh(order, picture, {kPlain});
    for (const Picture& picture : {kRandom8, kNatural16}) {
      sheet.tapered(order, "none", picture, {kPower});
      sheet.tapered(order, "hann", picture, {kPlain, kPower});
      sheet.tapered(order, "tukey=0.25", picture, {kPlain});
    }
  }
  for (const Picture& picture : {kRandom8, kNatural16}) {
    sheet.walsh(kOrders[1], picture, {kLowBand, kMidBand});
    sheet.tapered(kOrders[1], "none", picture, {kPowerBand});
    sheet.tapered(kOrders[1], "hann", picture, {kLowBand});
  }
}

void fill_rings(Sheet& sheet, bool small) {
  const std::vector<Picture> pictures =
      small ? std::vector<Picture>{kRandom8, kNatural16, {"flat", 8}, {"nearly-flat", 16}}
            : std::vector<Picture>{kNatural16};
  for (const Picture& picture : pictures) {
    sheet.fourier_rings("hann", picture);
    if (small) sheet.fourier_rings("none", picture);
    sheet.sequency_rings("none", picture);
    if (small) sheet.sequency_rings("tukey=0.25", picture);
  }
  if (small) sheet.fourier_rings("tukey=0.6", kRandom8);
}

/// What still ends today.
void fill_large(Sheet& sheet, bool largest) {
  if (largest) {
    sheet.fourier("hann", kNatural16, {kPlain, kPowerBand});
    sheet.fourier("none", kRandom8, {kPlain});
    sheet.tapered(kOrders[1], "hann", kNatural16, {kPlain});
  } else {
    sheet.fourier("hann", kNatural16, {kPlain, kPower, kLowBand});
    for (const char* content : {"random", "flat", "nearly-flat"}) {
      sheet.fourier("hann", {content, 8}, {kPlain});
    }
    sheet.fourier("none", kRandom8, {kPlain, kPowerBand});
    sheet.tapered(kOrders[0], "none", kRandom8, {kPower});
    sheet.tapered(kOrders[1], "hann", kNatural16, {kPlain});
    sheet.tapered(kOrders[2], "tukey=0.25", kRandom8, {kPlain});
  }
  for (const Order& order : kOrders) {
    for (const char* content : {"random", "natural", "full", "binary"}) {
      for (const int bits : {8, 16}) sheet.walsh(order, {content, bits}, {kPlain});
    }
  }
  for (const Picture& picture : {kRandom8, kNatural16}) {
    sheet.walsh(kOrders[1], picture, {kLowBand, kMidBand});
  }
}

void fill_cosine(Sheet& sheet, int n) {
  const std::vector<Weighing> all = {kPlain, kPower, kLowBand, kMidBand, kPowerBand};
  if (n <= 64) {
    for (const Picture& picture : every_picture()) {
      const bool typical = picture == kRandom8 || picture == kNatural16;
      sheet.cosine(picture, typical ? all : std::vector{kPlain});
    }
  } else {
    sheet.cosine(kRandom8, {kPlain});
    sheet.cosine(kNatural16, n <= 256 ? all : std::vector{kPlain, kLowBand});
  }
  if (n <= 256) sheet.cosine_rings(kNatural16);
  if (n <= 64) sheet.cosine_rings({"nearly-flat", 8});
}

std::vector<std::string> golden_lines(int largest_n) {
  std::vector<std::string> lines;
  for (int n = 8; n <= largest_n; n *= 2) {
    Sheet sheet(n);
    if (n <= 128) {
      fill_small(sheet);
    } else {
      fill_large(sheet, n == 512);
    }
    if (n <= 256) fill_rings(sheet, n <= 64);
    fill_cosine(sheet, n);
    lines.insert(lines.end(), sheet.lines().begin(), sheet.lines().end());
  }
  return lines;
}

int side_of(const std::string& line) { return std::stoi(line.substr(line.find(':') + 1)); }

int check(const char* path, int largest_n) {
  std::ifstream file(path);
  std::vector<std::string> stored;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] != '#' && side_of(line) <= largest_n) stored.push_back(line);
  }
  const auto fresh = golden_lines(largest_n);
  for (std::size_t i = 0; i < std::min(fresh.size(), stored.size()); ++i) {
    if (fresh[i] == stored[i]) continue;
    std::cerr << path << " holds  " << stored[i] << "\nbut it is   " << fresh[i] << '\n';
    return 1;
  }
  if (fresh.size() != stored.size()) {
    std::cerr << path << " holds " << stored.size() << " values up to N = " << largest_n << ", not "
              << fresh.size() << '\n';
    return 1;
  }
  std::cout << fresh.size() << " golden values are what the formulas give\n";
  return 0;
}

}  // namespace
}  // namespace fathom::golden

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "--check") {
    return fathom::golden::check(argv[2], std::stoi(argv[3]));
  }
  if (argc != 1) {
    std::cerr << "usage: make_golden [--check FILE LARGEST_N]\n";
    return 2;
  }
  std::cout << "# SPDX-License-Identifier: Apache-2.0\n"
               "# Written by tests/golden/make_golden.cpp; the columns are explained in "
               "golden_file.hpp.\n";
  for (const std::string& line : fathom::golden::golden_lines(512)) std::cout << line << '\n';
  return 0;
}
