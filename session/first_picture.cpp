// SPDX-License-Identifier: Apache-2.0
#include "session/first_picture.hpp"

#include <algorithm>
#include <cmath>

#include "focus/blur_fit.hpp"

namespace fathom {
namespace {

constexpr int kLeastSide = 48;      ///< Of what is compared, px.
constexpr double kDoubtPx = 0.75;   ///< What pixels and relief make of any blur.
constexpr double kByOptics = 0.01;  ///< Of a blur that optics tell.
constexpr double kSigmas = 3;

/// A square of the picture round the window that leaves a margin all round.
std::optional<Area> area_round(const Frame& frame, const Window& window, double blur_px,
                               int margin) {
  const int room = std::min(frame.width_px(), frame.height_px()) - 2 * margin;
  const int wanted = std::max({window.n, telling_side(blur_px), static_cast<int>(3 * blur_px)});
  const int n = std::min(wanted, room);
  if (n < kLeastSide) return std::nullopt;
  const int x = std::clamp(window.x + window.n / 2 - n / 2, margin, frame.width_px() - margin - n);
  const int y = std::clamp(window.y + window.n / 2 - n / 2, margin, frame.height_px() - margin - n);
  return Area{x, y, n, n};
}

/// What is asked of two pictures.
struct Question {
  const Window& window;
  double focus;
  BlurModel model;
  double doubt;  ///< A part of the blur.

  double foretold_px(const PictureAt& picture) const {
    return model.diameter_px(picture.position - focus);
  }
  double doubt_px(double blur_px) const { return kDoubtPx + kSigmas * doubt * blur_px; }
};

std::optional<FirstLook> look(const PictureAt& sharp, const PictureAt& first,
                              const Question& question, std::optional<double> beside_px,
                              bool is_exact = false) {
  constexpr int kForShifts = 24;
  const double foretold = question.foretold_px(first);
  const int margin = static_cast<int>(std::ceil(widest_tried(foretold) / 2)) + kForShifts;
  const auto area = area_round(sharp.frame, question.window, foretold, margin);
  const bool is_alike = sharp.frame.width_px() == first.frame.width_px() &&
                        sharp.frame.height_px() == first.frame.height_px();
  if (!area || !is_alike) return std::nullopt;
  const Area wide{area->x - margin, area->y - margin, area->width + 2 * margin,
                  area->height + 2 * margin};
  return look_at_first(patch_of(sharp.frame, wide), patch_of(first.frame, *area),
                       {.shape = question.model.shape,
                        .foretold_px = foretold,
                        .doubt_px = question.doubt_px(foretold),
                        .beside_px = beside_px,
                        .sharp_px = question.foretold_px(sharp),
                        .is_exact = is_exact,
                        .margin_px = margin});
}

/// How far the blur of the first picture may be off, by how far that of the one beside it is; nothing
/// where that one does not tell.
std::optional<double> doubt_beside(const FirstPictures& pictures, const Question& question) {
  constexpr double kExplains = 0.1, kLeastPart = 0.5, kMuch = 1.5, kUsual = 0.5;
  if (pictures.beside == nullptr) return std::nullopt;
  const double first_px = question.foretold_px(pictures.first);
  const double beside_px = question.foretold_px(*pictures.beside);
  if (beside_px < kLeastPart * first_px) return std::nullopt;
  const auto told = look(pictures.sharp, *pictures.beside, question, {}, true);
  if (!told || told->unexplained > kExplains) return std::nullopt;
  const double off = std::abs(told->seen_px - beside_px);
  const double beyond = std::max(0.0, off - kUsual * question.doubt_px(beside_px));
  return question.doubt_px(first_px) + kMuch * beyond * std::max(1.0, first_px / beside_px);
}

/// The picture beside is heard only where the law alone would doubt the first one.
std::optional<FirstLook> look(const FirstPictures& pictures, const Question& question) {
  const auto told = look(pictures.sharp, pictures.first, question, {});
  if (!told || !is_striking(*told)) return told;
  return look(pictures.sharp, pictures.first, question, doubt_beside(pictures, question));
}

}  // namespace

Patch patch_of(const Frame& frame, const Area& area) {
  Patch patch{area.width, area.height,
              std::vector<float>(static_cast<std::size_t>(area.width) * area.height)};
  float* grey = patch.greys.data();
  for (int y = area.y; y < area.y + area.height; ++y) {
    for (int x = area.x; x < area.x + area.width; ++x) *grey++ = static_cast<float>(frame.at(x, y));
  }
  return patch;
}

std::optional<FirstLook> look_at_first_picture(const FirstPictures& pictures, const Window& window,
                                               double focus, const BlurKnown& known,
                                               std::span<const Evaluation> evaluations) {
  const double doubt = known.is_by_optics ? kByOptics : known.model.uncertainty;
  const auto told = look(pictures, {window, focus, known.model, doubt});
  if (known.is_by_optics || !told || !contradicts(*told)) return told;
  const auto fit = fit_blur(evaluations, {.focus = focus});
  if (!fit) return std::nullopt;
  return look(pictures, {window, focus, fit->model, fit->model.uncertainty});
}

}  // namespace fathom
