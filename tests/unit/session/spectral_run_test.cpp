// SPDX-License-Identifier: Apache-2.0
// Searches by spectra on the simulated rig: what they keep computes again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/error.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"
#include "session/rig.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"

namespace fathom {
namespace {

RigOptions options_for(const std::string& rig) {
  RigOptions options;
  options.rig = rig;
  return options;
}

/// The file of one search, as it is read again.
RunFile kept(Rig& rig, const FocusRequest& request) {
  RunKeeper keeper(setup_of(rig));
  Session(rig).focus(request, keeper);
  return RunFile::parse(keeper.file.json(), "kept");
}

TEST(SpectralRun, ComputesAgainToTheSameAnswer) {
  FocusRequest budget;
  budget.frames = 3;
  FocusRequest spectral;
  spectral.search = SearchMethod::spectral;
  for (const char* place : {"sim:distance=1500,start=900", "sim:distance=2400,start=100,noise=24",
                            "sim:target=blank", "sim:target=seedling,start=1100"}) {
    for (const FocusRequest& request : {FocusRequest{}, spectral, budget}) {
      Rig rig(options_for(place));
      const RunFile file = kept(rig, request);
      const fathom::Run& run = file.runs.at(0);
      ASSERT_TRUE(run.limits->blur) << place;
      EXPECT_FALSE(run.measurements.front().picture.rings.empty()) << place;
      EXPECT_TRUE(run.focus->spectral_end) << place;
      EXPECT_TRUE(same_answer(file, rerun(file, "kept"))) << place;
    }
  }
}

/// Scores drown there: in a lamp that wanders as much as the noise, and from so far away that it took a
/// coarse pass to come near the focus.
TEST(SpectralRun, SpectraTellAFocusInMuchNoise) {
  struct Scene {
    double distance_mm;
    const char* rest;
  };
  for (const auto& [distance_mm, scene] :
       {Scene{1479.059, "seed=360655,start=274"}, Scene{1934.342, "seed=191969,start=461"},
        Scene{2362.853, "seed=949495,start=842"}}) {
    Rig rig(options_for(fmt::format("sim:noise=24,distance={},{}", distance_mm, scene)));
    const RunFile file = kept(rig, {});
    const Focus& focus = *file.runs.at(0).focus;
    EXPECT_EQ(focus.result(), FocusResult::focused) << scene;
    EXPECT_EQ(focus.spectral_end, SpectralEnd::found) << scene;
    EXPECT_NEAR(focus.position(), simulated::focused_position_steps(distance_mm),
                4 * focus.peak.sigma)
        << scene;
    EXPECT_TRUE(same_answer(file, rerun(file, "kept"))) << scene;
  }
}

/// So far from the focus that no ring of the window tells what is round it.
TEST(SpectralRun, AMotorThatLostStepsIsFoundOutWhereItBegan) {
  FocusRequest request;
  request.returns = true;
  for (const char* place : {"sim:target=seedling,distance=2577.76,seed=55014,start=95,lose=15",
                            "sim:target=seedling,distance=1401.97,seed=526891,start=387,lose=7",
                            "sim:target=orange,distance=2531.66,seed=303675,start=624,lose=16",
                            "sim:target=orange,distance=2119.99,seed=450092,start=196,lose=10"}) {
    Rig rig(options_for(place));
    const RunFile file = kept(rig, request);
    const fathom::Run& run = file.runs.at(0);
    EXPECT_FALSE(run.measurements.front().picture.cells.empty());
    EXPECT_EQ(run.focus->result(), FocusResult::no_focus) << place;
    EXPECT_EQ(run.focus->verdict.reason.why, Why::changed) << place;
    EXPECT_TRUE(same_answer(file, rerun(file, "kept"))) << place;
  }
}

TEST(SpectralRun, ARunOfOtherSpectraIsAnother) {
  Rig rig(options_for("sim:distance=1500,start=900"));
  RunFile file = kept(rig, {});
  for (Measurement& m : file.runs.at(0).measurements) {
    for (RingPowers& rings : m.picture.rings)
      std::fill(rings.powers.begin(), rings.powers.end(), 1.0F);
  }
  EXPECT_THROW(rerun(file, "kept"), Error);  // it would have looked elsewhere
}

/// From afar too few frames tell nothing, and that is said; near by they tell the focus.
TEST(SpectralRun, ABudgetIsKeptToFromAnywhere) {
  const double truth = simulated::focused_position_steps(1600);
  for (const int frames : {3, 4}) {
    for (int start = 0; start <= 1200; start += 80) {
      Rig rig(options_for("sim:distance=1600,start=" + std::to_string(start)));
      FocusRequest request;
      request.frames = frames;
      Observer nobody;
      const fathom::Run run = Session(rig).focus(request, nobody);
      EXPECT_LE(journey_of(run).frames, frames) << start;
      if (std::abs(start - truth) < 180) {
        EXPECT_EQ(run.focus->result(), FocusResult::focused) << start;
      }
      if (run.focus->result() != FocusResult::focused) continue;
      EXPECT_NEAR(run.focus->position(), truth, 4 * run.focus->peak.sigma)
          << frames << " frames from " << start;
    }
  }
}

TEST(SpectralRun, AWindowTooSmallForRingsIsSearchedByScores) {
  RigOptions options = options_for("sim:distance=1500,start=900");
  options.metric = "fft:8";
  Rig rig(options);
  Observer nobody;
  const fathom::Run run = Session(rig).focus({}, nobody);
  EXPECT_FALSE(run.limits->blur);
  EXPECT_FALSE(run.focus->spectral_end);
}

}  // namespace
}  // namespace fathom
