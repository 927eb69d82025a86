// SPDX-License-Identifier: Apache-2.0
// The program as a process among others: pipes, streams, signals, disks, and files that somebody
// else wrote.
#include <algorithm>
#include <filesystem>
#include <regex>

#include "pictures/picture.hpp"
#include "program.hpp"

namespace fathom::test {
namespace {

namespace fs = std::filesystem;

class Process : public Program {
 protected:
  /// Runs a line of shell in the test's folder, in which $F is the program.
  Outcome shell(const std::string& line) {
    write("line.sh", "cd " + path("") + "\nexport XDG_STATE_HOME=" + path("state") +
                         "\nF=" FATHOM_PROGRAM "\n" + line + "\n");
    const int raw = std::system(
        ("bash " + path("line.sh") + " >" + path("out.txt") + " 2>" + path("err.txt")).c_str());
    return {WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw), contents(path("out.txt")),
            contents(path("err.txt"))};
  }

  std::vector<fs::path> runs() const {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(path("state/fathom/runs")))
      all.push_back(entry.path());
    return all;
  }

  void write_grey(const std::string& name) const {
    std::string pixels(64 * 64, '\0');
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<char>(i * i % 251);
    write(name, "P5 64 64 255\n" + pixels);
  }
};

std::ptrdiff_t lines_in(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

/// Descriptor 3 is a pipe whose reader has ended, for certain.
const std::string kNobodyReads = "exec 3> >(true); wait $!; ";

TEST_F(Process, AMeasurementOutlivesItsReader) {
  for (const char* form : {"", " --json"}) {
    const Outcome outcome = shell(kNobodyReads + "$F focus --rig sim" + form + " >&3");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(lines_in(outcome.err), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("Broken pipe; run saved to "), std::string::npos) << outcome.err;
  }
  ASSERT_EQ(runs().size(), 2U);
  for (const fs::path& run : runs()) {
    const auto file = nlohmann::json::parse(contents(run));
    EXPECT_EQ(file.at("runs").at(0).at("focus").at("result"), "focused");
    EXPECT_FALSE(file.contains("error"));
  }
}

TEST_F(Process, AFullDiskBehindStandardOutputIsNoSuccess) {
  const Outcome outcome =
      shell("$F sweep --rig sim --from 700 --to 800 --step 50 --json >/dev/full");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("No space left on device; run saved to"), std::string::npos);
}

TEST_F(Process, ManyPicturesSayOnceThatNobodyReads) {
  write_grey("a.pgm");
  const Outcome outcome = shell(kNobodyReads + "$F score a.pgm a.pgm a.pgm a.pgm >&3");
  EXPECT_EQ(outcome.err, "fathom: cannot write to standard output: Broken pipe\n");
}

TEST_F(Process, ClosedStreamsAreTheNullDevice) {
  write_grey("a.pgm");
  EXPECT_EQ(shell("$F score a.pgm <&- >&- 2>&-").status, 0);
  // The run file is the first that is opened for writing: it must not get what is printed.
  ASSERT_EQ(shell("$F focus --rig sim -o run.json <&- >&- 2>&-").status, 0);
  EXPECT_TRUE(nlohmann::json::accept(contents(path("run.json"))));
}

TEST_F(Process, IgnoredSignalsStayIgnored) {
  const Outcome outcome = shell(
      "(trap '' INT HUP; exec $F sweep --rig sim --from 700 --to 800 --step 5 --json >rows.txt) &\n"
      "until [ -s rows.txt ]; do kill -0 $!; done\nkill -INT $!; kill -HUP $!\nwait $!");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(lines_in(contents(path("rows.txt"))), 21);
}

TEST_F(Process, WithoutAHomeItSaysWhereTheRunGoes) {
  const Outcome outcome = shell("env -u HOME -u XDG_STATE_HOME $F focus --rig sim");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.err.find("neither HOME nor XDG_STATE_HOME"), std::string::npos) << outcome.err;
  EXPECT_TRUE(fs::exists(path("fathom/runs")));
}

TEST_F(Process, RunsOfOneSecondAndOneProcessNumberAreAllKept) {
  // Each in a namespace of its own where that is allowed, so that their numbers are equal.
  const Outcome outcome = shell(
      "N='unshare --user --map-root-user --pid --fork'; $N true 2>/dev/null || N=\n"
      "for i in 1 2 3 4 5 6; do $N $F focus --rig sim --from 750 --to 800 & done; wait");
  EXPECT_EQ(lines_in(outcome.out), 18) << outcome.err;
  EXPECT_EQ(runs().size(), 6U);
}

TEST_F(Process, NumbersAreDecimalAndListsWhole) {
  write_grey("a.pgm");
  EXPECT_EQ(fathom("score a.pgm --metric fft:16 --grid 024").out,
            fathom("score a.pgm --metric fft:16 --grid 24").out);
  expect_refusal("focus --rig sim --average 0x10", 2, {"--average", "0x10"});
  expect_refusal("focus --rig sim --from 0x10", 2, {"--from", "0x10"});
  expect_refusal("focus --rig sim --from 1e999", 2, {"--from", "1e999"});
  for (const char* list : {" 1400,,1500", " ,1400", " 1400,1500,", "=1400,,1500"}) {
    expect_refusal(std::string("calibrate --rig sim -o c.json --distances") + list, 2,
                   {"--distances", "missing"});
  }
  expect_refusal("range --rig sim --calibration c --continuous --count 0", 2, {"--count"});
}

TEST_F(Process, NamesReachNoTerminalRaw) {
  const std::string name = "a\x1b[31m\u009b\n.pgm";
  write_grey(name);
  const Outcome text = shell("$F score a*.pgm"), json = shell("$F score a*.pgm --json");
  EXPECT_NE(text.out.find("a\\x1b[31m\\xc2\\x9b\\x0a.pgm"), std::string::npos) << text.out;
  EXPECT_EQ(lines_in(text.out), 1);
  EXPECT_EQ(json.lines().at(0).at("image"), name);
  EXPECT_EQ(json.out.find('\x1b'), std::string::npos);
  EXPECT_EQ(json.out.find("\u009b"), std::string::npos);
}

TEST_F(Process, TwoCapturesNeverShareAFolder) {
  const Outcome outcome = shell(
      "for i in 1 2 3 4; do $F capture --rig sim --from 700 --to 720 --step 10 -o stack & done\n"
      "wait");
  EXPECT_EQ(lines_in(outcome.out), 1) << outcome.out;
  EXPECT_EQ(lines_in(outcome.err), 3) << outcome.err;
  EXPECT_EQ(lines_in(contents(path("stack/manifest.csv"))), 6);
}

// A full disk, played by a limit on the size of files.
TEST_F(Process, ACaptureThatEndsEarlyKeepsWhatItsManifestNames) {
  const Outcome outcome =
      shell("ulimit -f 16; $F capture --rig sim --from 700 --to 760 --step 20 -o full");
  EXPECT_FALSE(fs::exists(path("full"))) << "no picture, no folder";
  EXPECT_NE(outcome.err.find("full/frame_00000.png: File too large"), std::string::npos);
  // In the foreground, for else timeout would signal twice.
  const Outcome stopped =
      shell("timeout --foreground -s INT 2 $F capture --rig sim --average 20 -o stack");
  EXPECT_NE(stopped.err.find("frames taken before are whole, in stack"), std::string::npos)
      << stopped.err;
  EXPECT_LT(shell("$F focus --rig replay:stack").status, 4);
  EXPECT_EQ(fathom("sweep --rig replay:stack --json").lines().size(),
            static_cast<std::size_t>(lines_in(contents(path("stack/manifest.csv"))) - 3));
}

TEST_F(Process, AMapOfASweepThatWasStoppedIsWrittenAndIsNoSuccess) {
  const Outcome stopped = shell(
      "timeout --foreground --preserve-status -s INT 2 $F depth --rig sim:target=seedling "
      "--from 800 --to 1100 --step 1 --average 50 -o map");
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_NE(stopped.err.find("stopped after "), std::string::npos) << stopped.err;
  EXPECT_EQ(fs::exists(path("map/report.json")),
            stopped.err.find("the map is of these") != std::string::npos);
}

TEST_F(Process, AFolderThatWasCutOffBeforeItsFirstPictureIsNoStack) {
  // What a SIGKILL between the manifest and the first picture's entry leaves.
  fs::create_directory(path("cut"));
  write("cut/manifest.csv", "# unit: steps\nfile,position\n");
  write_grey("cut/frame_00000.pgm");
  expect_refusal("focus --rig replay:cut", 1, {"lists no pictures"});
}

TEST_F(Process, FilesThatNestTooDeepAreRefused) {
  const std::string brackets(80000, '[');
  write("bare.json", brackets);
  write("run.json",
        R"({"format":"fathom-run","version":)" + brackets + std::string(80000, ']') + "}");
  for (const char* file : {"bare.json", "run.json"}) {
    expect_refusal(std::string("rerun ") + file, 1, {file, "nest too deep"});
    expect_refusal(std::string("range --rig sim --calibration ") + file, 1,
                   {file, "nest too deep"});
  }
  std::string key;
  for (int i = 0; i < 40000; ++i) key += "a.";
  write("key.toml", key + "b = 1\n");
  write("table.toml", "[" + key + "b]\n");
  write("list.toml", "driver = \"sim\"\nx = " + brackets + "\n");
  for (const char* file : {"key.toml", "table.toml", "list.toml"})
    expect_refusal(std::string("focus --rig ") + file, 1, {file, "nests too deep"});
  write("good.toml", "# " + key + "\ndriver = \"sim\"\ntarget = 'usaf'  # " + key + "\n");
  EXPECT_EQ(fathom("focus --rig good.toml").status, 0);
}

TEST_F(Process, AnEditedRunIsNotTheSame) {
  ASSERT_EQ(fathom("focus --rig sim -o run.json").status, 0);
  const std::string text = contents(path("run.json"));
  const struct {
    const char *what, *edited, *said;
  } edits[] = {
      {R"("settled_ns": \d+)", R"("settled_ns": 4e49)", "whole number"},
      {R"("settled_ns": \d+)", R"("settled_ns": 99999999999999999999)", "whole number"},
      {R"("settled_ns": \d+)", R"("settled_ns": 12)", "changed after it was written"},
      {R"("average": 1)", R"("average": 4294967297)", "whole number"},
      {R"("rig": "sim")", R"("rig": "sim:distance=1900")", "changed after it was written"},
      {R"("window": \[\s*\d+)", R"("window": [ 17)", "changed after it was written"},
      {R"(("sigma": 0.\d\d\d\d\d\d\d\d\d)\d\d)", R"($01)", "changed after it was written"},
      {R"("sigma": 0.\d)", R"("sigma": 7.0)", "does not come to the answer"},
      {R"("confidence": 0.\d)", R"("confidence": 0.3)", "does not come to the answer"},
  };
  for (const auto& edit : edits) {
    const std::string changed = std::regex_replace(text, std::regex(edit.what), edit.edited,
                                                   std::regex_constants::format_first_only);
    ASSERT_NE(changed, text) << edit.what;
    write("edited.json", changed);
    expect_refusal("rerun edited.json", 1, {"edited.json", edit.said});
  }
  write("laid-out.json", nlohmann::ordered_json::parse(text).dump());
  EXPECT_EQ(fathom("rerun laid-out.json").status, 0);
  write("without.json", std::regex_replace(text, std::regex(R"(,\s*"digest": "\w+")"), ""));
  EXPECT_NE(fathom("rerun without.json").err.find("cannot be checked"), std::string::npos);
}

TEST_F(Process, WithoutThreadsTheCpuComputesAlone) {
  const Outcome probe = shell("LD_PRELOAD=" FATHOM_NO_THREADS " $F --version");
  if (probe.status != 0) GTEST_SKIP() << "a sanitizer preloads itself: " << probe.err;
  write_grey("a.pgm");
  const std::string score = "$F score a.pgm --metric fft:8 --grid 1 --json";
  const std::string alone = "FATHOM_CACHE=" + path("cache") + " LD_PRELOAD=" FATHOM_NO_THREADS " ";
  const Outcome with = shell(score), without = shell(alone + score);
  EXPECT_EQ(without.status, 0) << without.err;
  EXPECT_EQ(without.out, with.out);
  EXPECT_EQ(shell(alone + score + " --threads 4").out, with.out);
  for (const char* backend : {"opencl", "vulkan"}) {
    const Outcome refused = shell(alone + score + " --backend " + backend);
    EXPECT_EQ(refused.status, 1);
    EXPECT_EQ(lines_in(refused.err), 1) << refused.err;
  }
  const Outcome listed = shell(alone + "$F devices");
  EXPECT_EQ(listed.status, 0) << listed.err;
  EXPECT_FALSE(fs::exists(path("cache/devices-opencl"))) << "no list to keep";
}

TEST_F(Process, ABackendFromAVariableIsSaidToBe) {
  write_grey("a.pgm");
  const Outcome outcome = shell("FATHOM_BACKEND=abacus $F score a.pgm");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("FATHOM_BACKEND=abacus: no backend"), std::string::npos)
      << outcome.err;
}

TEST_F(Process, ACalibrationAndARunAreToldApart) {
  ASSERT_EQ(
      fathom("calibrate --rig sim --distances 1400,2000,2600 -o cal.json --run run.json").status,
      0);
  expect_refusal("rerun cal.json", 1, {"cal.json", "it is a calibration"});
  expect_refusal("range --rig sim --calibration run.json", 1, {"run.json", "it is a run"});
}

}  // namespace
}  // namespace fathom::test
