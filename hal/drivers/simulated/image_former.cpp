// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/image_former.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "engine/optics.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {
namespace {

using Complex = std::complex<float>;
constexpr int kHalfCells = kFieldCells / 2;
constexpr double kFieldMm = kFieldPx * kPitchMm;

constexpr std::size_t at(int row, int col, int width) {
  return static_cast<std::size_t>(row) * width + col;
}

/// Transfer function of a disc, 2 J1(x)/x, tabulated: x = pi * diameter * frequency.
class DiscTable {
 public:
  explicit DiscTable(double largest) {
    const int size = static_cast<int>(largest * kPerUnit) + 2;
    values_.reserve(size);
    for (int i = 0; i < size; ++i) {
      values_.push_back(static_cast<float>(optics::disc_otf(i / double{kPerUnit})));
    }
  }

  float operator()(float x) const {
    const float place = x * kPerUnit;
    const int index = static_cast<int>(place);
    const float part = place - static_cast<float>(index);
    return values_[index] + part * (values_[index + 1] - values_[index]);
  }

 private:
  static constexpr float kPerUnit = 32;
  std::vector<float> values_;
};

/// What the pixel adds to the cells' own area, for one axis: the mean of two neighbours, and the
/// factor 1/2 by which the folded inverse transform is too large.
Complex pixel_aperture(int frequency) {
  const int signed_frequency = frequency < kHalfCells ? frequency : frequency - kFieldCells;
  const double angle = std::numbers::pi * signed_frequency / kFieldCells;
  return Complex(std::polar(0.5 * std::cos(angle), angle));
}

}  // namespace

/// Two-dimensional transforms as rows, a transposition and rows again.
class ImageFormer::Transforms {
 public:
  Transforms()
      : disc_(std::numbers::pi * kLargestDiscMm * std::numbers::sqrt2 * kHalfCells / kFieldMm),
        radii_(at(kHalfCells + 1, 0, kHalfCells + 1)),
        disc_transfer_(radii_.size()) {
    for (int row = 0; row <= kHalfCells; ++row) {
      for (int col = 0; col <= kHalfCells; ++col) {
        radii_[at(row, col, kHalfCells + 1)] = static_cast<float>(std::hypot(row, col) / kFieldMm);
      }
    }
  }

  /// Spectrum of a layer, with the aperture of the pixels.
  Field forward(std::span<const Complex> cells) {
    Field rows(cells.size()), spectrum(cells.size());
    transform_rows(cells, rows, kFieldCells, Direction::forward);
    transform_rows(rows, spectrum, kFieldCells, Direction::forward);
    for (int row = 0; row < kFieldCells; ++row) {
      for (int col = 0; col < kFieldCells; ++col) {
        spectrum[at(row, col, kFieldCells)] *= pixel_aperture(row) * pixel_aperture(col);
      }
    }
    return spectrum;
  }

  /// A layer on the pixels, blurred by a disc; [row][col] of kFieldPx squared.
  Field blurred(const Field& spectrum, double diameter_mm) {
    set_disc(std::min(diameter_mm, kLargestDiscMm));
    Field folded(at(kFieldPx, 0, kFieldPx)), rows(folded.size());
    fold(spectrum, folded);
    transform_rows(folded, rows, kFieldPx, Direction::inverse);
    transform_rows(rows, folded, kFieldPx, Direction::inverse);
    return folded;
  }

 private:
  enum class Direction { forward, inverse };

  /// A larger disc would meet itself across the field's repeating edges, and shows nothing more.
  static constexpr double kLargestDiscMm = kFieldMm;

  void transform_rows(std::span<const Complex> in, Field& transposed, int side,
                      Direction direction) {
    line_.resize(side);
    for (int row = 0; row < side; ++row) {
      const Complex* source = in.data() + at(row, 0, side);
      if (direction == Direction::forward) {
        fft_.impl().fwd(line_.data(), source, side);
      } else {
        fft_.impl().inv(line_.data(), source, side);
      }
      for (int col = 0; col < side; ++col) transposed[at(col, row, side)] = line_[col];
    }
  }

  void set_disc(double diameter_mm) {
    const float scale = static_cast<float>(std::numbers::pi * diameter_mm);
    for (std::size_t i = 0; i < radii_.size(); ++i) disc_transfer_[i] = disc_(scale * radii_[i]);
  }

  /// Multiplies with the disc's transfer function and adds the four frequencies that the pixels
  /// cannot tell apart. The transfer function is even, so one quarter of it serves all four.
  void fold(const Field& spectrum, Field& folded) const {
    constexpr int quarter = kHalfCells + 1;
    const float scale = 1.0f / (kFieldPx * kFieldPx);
    for (int row = 0; row < kFieldPx; ++row) {
      const Complex* low = spectrum.data() + at(row, 0, kFieldCells);
      const Complex* high = spectrum.data() + at(row + kHalfCells, 0, kFieldCells);
      const float* low_disc = disc_transfer_.data() + at(row, 0, quarter);
      const float* high_disc = disc_transfer_.data() + at(kHalfCells - row, 0, quarter);
      for (int col = 0; col < kFieldPx; ++col) {
        const int mirrored = kHalfCells - col;
        const Complex sum = low[col] * low_disc[col] + low[col + kHalfCells] * low_disc[mirrored] +
                            high[col] * high_disc[col] +
                            high[col + kHalfCells] * high_disc[mirrored];
        folded[at(row, col, kFieldPx)] = sum * scale;
      }
    }
  }

  DiscTable disc_;
  std::vector<float> radii_;  ///< Cycles per mm of a quarter of the spectrum.
  std::vector<float> disc_transfer_;
  Eigen::FFT<float> fft_;
  std::vector<Complex> line_;
};

ImageFormer::ImageFormer(const Scene& scene) : transforms_(std::make_unique<Transforms>()) {
  for (const Layer& layer : scene.layers) spectra_.push_back(transforms_->forward(layer.cells()));
}

ImageFormer::~ImageFormer() = default;
ImageFormer::ImageFormer(ImageFormer&&) noexcept = default;
ImageFormer& ImageFormer::operator=(ImageFormer&&) noexcept = default;

std::vector<float> ImageFormer::picture(std::span<const double> disc_diameters_mm) {
  std::vector<float> light(at(kHeightPx, 0, kWidthPx), static_cast<float>(kGreyCard));
  constexpr std::size_t cropped = at((kFieldPx - kHeightPx) / 2, 0, kFieldPx);
  for (std::size_t layer = 0; layer < spectra_.size(); ++layer) {
    const Field card = transforms_->blurred(spectra_[layer], disc_diameters_mm[layer]);
    for (std::size_t i = 0; i < light.size(); ++i) {
      const Complex pixel = card[cropped + i];
      light[i] = pixel.real() + (1 - pixel.imag()) * light[i];
    }
  }
  return light;
}

}  // namespace fathom::simulated
