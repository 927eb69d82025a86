// SPDX-License-Identifier: Apache-2.0
#include "session/lens_blur.hpp"

#include <utility>

#include "engine/error.hpp"
#include "focus/blur_fit.hpp"
#include "session/run_store.hpp"

namespace fathom {
namespace {

bool is_by_spectra(const FocusRequest& request) {
  return request.search == SearchMethod::automatic || request.search == SearchMethod::spectral;
}

}  // namespace

LensBlur::LensBlur(Rig& rig, const FocusRequest& request, Keeping keeping,
                   const Calibration* calibration)
    : rig_(rig), request_(request), keeping_(std::move(keeping)) {
  is_wanted_ = rig.camera().is_live() && rig.has_spectra() && !rig.blur();
  if (!is_wanted_) return;
  try {
    if (keeping_.store) kept_ = keeping_.store->find(blur_key(rig));
  } catch (const Error& error) {
    keeping_.noted({.news = BlurNews::not_read, .px_per_unit = 0, .text = error.what()});
  }
  choose(calibration);
}

void LensBlur::choose(const Calibration* calibration) {
  if (request_.blur || !is_by_spectra(request_)) {
    follows_kept_ = false;
  } else if (calibration != nullptr && calibration->conditions().blur) {
    follows_kept_ = false;
    request_.blur = calibration->conditions().blur;
    keeping_.noted(
        {.news = BlurNews::of_calibration, .px_per_unit = request_.blur->px_per_unit, .text = ""});
  } else if (kept_) {
    request_.blur = kept_->model;
    keeping_.noted({.news = BlurNews::of_before,
                    .px_per_unit = request_.blur->px_per_unit,
                    .text = kept_->learned.substr(0, kept_->learned.find('T'))});
  }
}

void LensBlur::learn(const Run& run) {
  if (!is_wanted_) return;
  const auto now = blur_of(run);
  if (!now) return;
  const bool is_known = kept_ && agree(kept_->model, now->model);
  if (is_known && kept_->model.uncertainty <= now->model.uncertainty) return;
  kept_ = now;
  kept_->learned = utc_now();
  if (follows_kept_) request_.blur = kept_->model;
  const bool is_kept = keep();
  if (is_known) return;
  keeping_.noted({.news = is_kept ? BlurNews::learned : BlurNews::learned_once,
                  .px_per_unit = now->model.px_per_unit,
                  .text = ""});
}

bool LensBlur::keep() const {
  try {
    if (keeping_.store) keeping_.store->keep(blur_key(rig_), *kept_);
    return keeping_.store.has_value();
  } catch (const Error& error) {
    keeping_.noted({.news = BlurNews::not_kept, .px_per_unit = 0, .text = error.what()});
    return false;
  }
}

}  // namespace fathom
