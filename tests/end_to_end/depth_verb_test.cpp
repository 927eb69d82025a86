// SPDX-License-Identifier: Apache-2.0
// fathom depth on stacks whose depth is known: what it leaves, and what it refuses.
#include <gtest/gtest.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pictures/picture.hpp"
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 192, kHeight = 144, kFrames = 9;
constexpr std::size_t kPixels = std::size_t{1} * kWidth * kHeight;

/// A plane that rises from frame 2 on the left to frame 6 on the right.
double true_depth(int x) { return 2 + 4.0 * x / (kWidth - 1); }

std::vector<double> blurred(const std::vector<double>& from) {
  std::vector<double> to(kPixels);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double sum = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          const int row = std::clamp(y + j, 0, kHeight - 1),
                    column = std::clamp(x + i, 0, kWidth - 1);
          sum += (2 - std::abs(i)) * (2 - std::abs(j)) *
                 from[static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column)];
        }
      }
      to[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)] = sum / 16;
    }
  }
  return to;
}

/// The texture, blurred by a Gaussian of 1, 2, 3 ... times the variance of one pass.
std::vector<std::vector<double>> blur_series(int length) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1);
  std::vector<double> grain(kPixels);
  for (double& value : grain) value = 120 + 70 * normal(random);
  std::vector<std::vector<double>> series = {blurred(grain)};
  while (static_cast<int>(series.size()) < length) series.push_back(blurred(series.back()));
  return series;
}

class DepthVerb : public Program {
 protected:
  /// Frames of the plane as PPM or PGM, frame_0 to frame_8. Variance grows with the square of the
  /// distance from focus.
  void make_stack(const std::string& folder, bool in_colour = true) {
    static const auto series = blur_series(90);
    fs::create_directories(path(folder));
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.7);
    for (int z = 0; z < kFrames; ++z) {
      std::string file = std::string(in_colour ? "P6" : "P5") + "\n192 144\n255\n";
      for (std::size_t i = 0; i < kPixels; ++i) {
        const double away = z - true_depth(static_cast<int>(i % kWidth));
        const double passes = std::min(2.0 * away * away, 88.0);
        const auto whole = static_cast<std::size_t>(passes);
        const double part = passes - static_cast<double>(whole);
        const double value =
            (1 - part) * series[whole][i] + part * series[whole + 1][i] + noise(random);
        const auto level = [&](double factor) {
          return static_cast<char>(std::lround(std::clamp(factor * value, 0.0, 255.0)));
        };
        file += level(1);
        if (in_colour) file += {level(0.8), level(0.4)};
      }
      write(folder + "/frame_" + std::to_string(z) + (in_colour ? ".ppm" : ".pgm"), file);
    }
  }

  /// The floats of a TIFF, in its one strip as it lies there ("c"), and its description.
  struct FloatTiff {
    int width = 0, height = 0;
    std::vector<float> values;
    std::string description;
  };
  FloatTiff read_floats(const std::string& name) {
    FloatTiff result;
    TIFF* const tiff = TIFFOpen(path(name).c_str(), "rc");
    EXPECT_NE(tiff, nullptr) << name;
    if (tiff == nullptr) return result;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &result.width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &result.height);
    char* text = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) == 1) result.description = text;
    result.values.resize(std::size_t{1} * result.width * result.height);
    const auto bytes = static_cast<tmsize_t>(result.values.size() * sizeof(float));
    EXPECT_EQ(TIFFReadEncodedStrip(tiff, 0, result.values.data(), bytes), bytes);
    TIFFClose(tiff);
    return result;
  }

  std::vector<std::string> names_in(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path(folder)))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(DepthVerb, MapsAPlaneAndLeavesEveryFile) {
  make_stack("s");
  write("regions.csv", "x,y,n\n8,60,24\n# the middle\n84,60,24\n");
  const Outcome outcome =
      fathom("depth --rig replay:s -o map --ply --obj --regions regions.csv --csv regions_out.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(names_in("map"),
            (std::vector<std::string>{"class.png", "confidence.tif", "depth.obj", "depth.ply",
                                      "depth.png", "depth.tif", "hill.png", "index.tif",
                                      "report.json", "sharp.png", "sigma.tif", "view.html"}));
  const FloatTiff depth = read_floats("map/depth.tif"), sigma = read_floats("map/sigma.tif");
  ASSERT_EQ(depth.width, kWidth);
  ASSERT_EQ(depth.height, kHeight);
  double squares = 0, known = 0;
  for (int y = 16; y < kHeight - 16; ++y) {
    for (int x = 16; x < kWidth - 16; ++x) {
      const auto i = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
      EXPECT_EQ(std::isnan(depth.values[i]), std::isnan(sigma.values[i]));
      if (std::isnan(depth.values[i])) continue;
      squares += std::pow(depth.values[i] - true_depth(x), 2);
      known += 1;
    }
  }
  EXPECT_GT(known, 0.8 * (kWidth - 32) * (kHeight - 32));
  EXPECT_LT(std::sqrt(squares / known), 0.25);  // frames
  const auto report = nlohmann::json::parse(contents(path("map/report.json")));
  EXPECT_EQ(report["frames"], kFrames);
  EXPECT_EQ(report["depth"]["unit"], "frames");
  EXPECT_EQ(report["gains"].size(), kFrames);
  EXPECT_EQ(report["places"][kFrames - 1]["scale"], 1);
  EXPECT_EQ(report["classes"][2]["name"], "no-texture");
  const std::string csv = contents(path("regions_out.csv"));
  EXPECT_EQ(csv.rfind("x,y,n,position,sigma,verdict,known\n8,60,24,", 0), 0u) << csv;
  const double middle = std::stod(csv.substr(csv.find("84,60,24,") + 9));
  EXPECT_NEAR(middle, true_depth(96), 0.25);
  EXPECT_NE(outcome.out.find("known"), std::string::npos);
}

TEST_F(DepthVerb, MakesASharpPictureInColour) {
  make_stack("s");
  ASSERT_EQ(fathom("depth --rig replay:s -o map --sharp-tiff").status, 0);
  const auto sharpest = blur_series(1)[0];
  Colours colours;
  PictureFile(path("map/sharp.tif")).read(0, colours);
  ASSERT_EQ(colours.bits8.size(), 3 * kPixels);
  double off = 0, off_in_one = 0;
  Colours one;
  PictureFile(path("s/frame_4.ppm")).read(0, one);
  for (std::size_t i = 0; i < kPixels; ++i) {
    const double truth = std::clamp(sharpest[i], 0.0, 255.0);
    off += std::pow(colours.bits8[3 * i] - truth, 2);
    off_in_one += std::pow(one.bits8[3 * i] - truth, 2);
    EXPECT_NEAR(colours.bits8[3 * i + 2], 0.4 * colours.bits8[3 * i], 4);
  }
  EXPECT_LT(off, 0.25 * off_in_one);
  const Frame index = PictureFile(path("map/index.tif")).read();
  EXPECT_NEAR(index.at(20, 70), true_depth(20), 1.01);
  EXPECT_NEAR(index.at(170, 70), true_depth(170), 1.01);
}

TEST_F(DepthVerb, CountsInMillimetresWithACalibration) {
  make_stack("s", false);
  std::string manifest = "# unit: steps\nfile,position\n", points = "position,distance_mm\n";
  for (int z = kFrames - 1; z >= 0; --z)  // unsorted, too
    manifest += "frame_" + std::to_string(z) + ".pgm," + std::to_string(100 + 10 * z) + "\n";
  write("s/manifest.csv", manifest);
  for (int position = 100; position <= 180; position += 10)
    points += std::to_string(position) + "," + std::to_string(500 + 2 * position) + "\n";
  write("points.csv", points);
  ASSERT_EQ(fathom("calibrate --from points.csv --model auto -o cal.json").status, 0);
  const Outcome outcome = fathom("depth --rig replay:s --calibration cal.json -o map --fill");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const FloatTiff depth = read_floats("map/depth.tif");
  EXPECT_NE(depth.description.find("mm"), std::string::npos);
  std::vector<float> offs;
  for (int y = 20; y < kHeight - 20; ++y) {
    for (int x = 20; x < kWidth - 20; ++x) {
      const float value = depth.values[static_cast<std::size_t>(y) * kWidth + x];
      ASSERT_FALSE(std::isnan(value));  // --fill
      offs.push_back(std::abs(value - static_cast<float>(700 + 20 * true_depth(x))));
    }
  }
  std::nth_element(offs.begin(), offs.begin() + offs.size() / 2, offs.end());
  EXPECT_LT(offs[offs.size() / 2], 5);  // a quarter of a frame
  EXPECT_NE(outcome.out.find(" mm"), std::string::npos);

  ASSERT_EQ(fathom("calibrate --rig sim --distances 1300,1500,1800,2300 -o sim.json").status, 0);
  make_stack("plain", false);
  const Outcome other = fathom("depth --rig replay:plain --calibration sim.json -o other");
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("positions in steps, this rig counts frames"), std::string::npos);
  EXPECT_FALSE(fs::exists(path("other")));
}

TEST_F(DepthVerb, SweepsALiveRig) {
  const Outcome outcome =
      fathom("depth --rig sim:distance=1500 --from 800 --to 1100 --step 15 -o map --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["frames"], 21);
  EXPECT_EQ(report["position_unit"], "steps");
  EXPECT_GT(report["classes"][0]["part"], 0.5);
}

TEST_F(DepthVerb, SaysWhatAStackLacks) {
  make_stack("s", false);
  fs::create_directories(path("two"));
  for (const char* name : {"frame_0.pgm", "frame_1.pgm"})
    fs::copy_file(path("s") + "/" + name, path("two") + "/" + name);
  write("s/manifest.csv", "file,position\nframe_0.pgm,0\nframe_1.pgm,5\nframe_2.pgm,9\n");
  write("over.csv", "150,10,64\n");
  write("bad.csv", "1,2,3\n4,5\n");
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"--rig replay:two", {"3 positions", "has 2"}},
      {"--rig replay:s --window 256", {"--window 256", "192 x 144"}},
      {"--rig replay:s --stride 1000", {"--stride 1000", "192 x 144"}},
      {"--rig replay:s --window 17", {"17"}},
      {"--rig replay:s --window big", {"--window big", "auto"}},
      {"--rig replay:s --regions over.csv --csv o.csv", {"150,10,64", "192 x 144"}},
      {"--rig replay:s --regions bad.csv --csv o.csv", {"bad.csv line 2", "x,y,n"}},
      {"--rig replay:s --csv o.csv", {"--regions"}},
      {"--rig replay:nowhere", {"nowhere"}},
      {"--rig replay:s --calibration nowhere.json", {"nowhere.json"}}};
  for (const auto& [arguments, words] : cases) {
    const Outcome outcome = fathom("depth -o map " + arguments);
    EXPECT_NE(outcome.status, 0) << arguments;
    for (const std::string& word : words)
      EXPECT_NE(outcome.err.find(word), std::string::npos) << arguments << "\n" << outcome.err;
    EXPECT_FALSE(fs::exists(path("map"))) << arguments;  // nothing half-written
  }
  expect_refusal("depth --rig replay:s -o over.csv", 2, {"over.csv", "no folder"});
  for (const char* option : {"--window 256", "--window 300", "--stride 1000"})
    EXPECT_EQ(fathom(std::string("depth --rig replay:s -o map ") + option).status, 2) << option;
}

TEST_F(DepthVerb, RefusesGreyAmongColours) {
  make_stack("s");
  make_stack("grey", false);
  fs::remove(path("s/frame_4.ppm"));
  fs::copy_file(path("grey/frame_4.pgm"), path("s/frame_4.pgm"));
  const Outcome outcome = fathom("depth --rig replay:s -o map");
  EXPECT_EQ(outcome.status, 1);
  for (const char* word : {"frame_4.pgm is grey", "frame_0.ppm is in colour"})
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(path("map")));
}

TEST_F(DepthVerb, SaysWhereNothingHasADepth) {
  std::mt19937 random(5);
  fs::create_directories(path("noise"));
  for (int z = 0; z < kFrames; ++z) {
    std::string file = "P5\n192 144\n255\n";
    for (std::size_t i = 0; i < kPixels; ++i) file += static_cast<char>(100 + random() % 9);
    write("noise/frame_" + std::to_string(z) + ".pgm", file);
  }
  const Outcome noise = fathom("depth --rig replay:noise -o map");
  EXPECT_EQ(noise.status, 3) << noise.out;
  EXPECT_NE(noise.err.find("nothing changes with the lens"), std::string::npos) << noise.err;
  EXPECT_TRUE(fs::exists(path("map/report.json")));
  const Outcome beyond =
      fathom("depth --rig sim:target=usaf,distance=1500 --from 600 --to 800 --step 10 -o beyond");
  EXPECT_EQ(beyond.status, 3) << beyond.out;
  EXPECT_NE(beyond.err.find("at an end of the range"), std::string::npos) << beyond.err;
}

TEST_F(DepthVerb, LeavesWhatWasThereWhereTheDiskIsFull) {
  make_stack("s", false);
  fs::create_directories(path("map"));
  write("map/depth.tif", "old");
  write("map/mine.txt", "mine");
  // A block of ulimit is 512 or 1024 bytes: the pictures take more.
  const Outcome outcome = fathom("depth --rig replay:s -o map", "ulimit -f 60;");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("cannot write map/"), std::string::npos) << outcome.err;
  EXPECT_EQ(names_in("map"), (std::vector<std::string>{"depth.tif", "mine.txt"}));
  EXPECT_EQ(contents(path("map/depth.tif")), "old");
  ASSERT_EQ(fathom("depth --rig replay:s -o map").status, 0);
  EXPECT_EQ(contents(path("map/mine.txt")), "mine");
  EXPECT_GT(contents(path("map/depth.tif")).size(), 4 * kPixels);
}

TEST_F(DepthVerb, MakesAPageThatNeedsNothingBesideIt) {
  make_stack("s");
  ASSERT_EQ(fathom("depth --rig \"replay:s\" -o \"map</script>\"").status, 0);
  const std::string page = contents(path("map</script>/view.html"));
  for (const char* outside : {"http:", "https:", "src=\"", "href=", "@import", "fetch("})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  EXPECT_NE(page.find("data:image/jpeg;base64,"), std::string::npos);
  const std::string open = "<script id=\"data\" type=\"application/json\">";
  const std::size_t from = page.find(open) + open.size();
  const auto data = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  EXPECT_EQ(data["width"], kWidth);
  EXPECT_EQ(data["positions"].size(), kFrames);
  const std::size_t numbers = data["columns"].get<std::size_t>() * data["rows"].get<std::size_t>();
  EXPECT_EQ(data["depth"]["values"].get<std::string>().size(), (2 * numbers + 2) / 3 * 4);
}

}  // namespace
}  // namespace fathom::test
