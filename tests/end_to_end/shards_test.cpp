// SPDX-License-Identifier: Apache-2.0
// fathom score --shard and fathom merge: what many processes print is what one would have printed.
#include "pictures/picture.hpp"
#include "tests/end_to_end/program.hpp"
#include "tests/unit/pictures/raw_tiff.hpp"

namespace fathom::test {
namespace {

class Shards : public Program {
 protected:
  /// What is printed by each shard, into 1.json to N.json; their names with blanks between.
  std::string run(const std::string& arguments, int shards) {
    std::string names;
    for (int i = 1; i <= shards; ++i) {
      const std::string name = std::to_string(i) + ".json";
      write(name, fathom("score " + arguments + " --json --shard " + std::to_string(i) + "/" +
                         std::to_string(shards))
                      .out);
      names += " " + name;
    }
    return names;
  }

  std::string alone(const std::string& arguments) {
    return fathom("score " + arguments + " --json").out;
  }

  static Frame picture(int width, int height, int seed) {
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < width * height; ++i)
      pixels.push_back(static_cast<std::uint8_t>((i * (seed + 6)) % 251));
    return Frame(width, height, std::move(pixels));
  }

  void write_pictures(int count) {
    for (int i = 0; i < count; ++i)
      write_picture(path("p" + std::to_string(i) + ".pgm"), picture(90, 80, i + 1));
  }

  std::vector<std::string> lines(const std::string& name) const {
    std::istringstream stream(contents(path(name)));
    std::vector<std::string> all;
    for (std::string line; std::getline(stream, line);) all.push_back(line);
    return all;
  }
};

TEST_F(Shards, OfPicturesMergeToWhatOneProcessPrints) {
  write_pictures(5);
  const std::string command = "p0.pgm p1.pgm p2.pgm p3.pgm p4.pgm --grid 8 --metric walsh-paley:64";
  const std::string whole = alone(command);
  for (const int shards : {1, 2, 3, 5, 7}) {
    const Outcome merged = fathom("merge table.json" + run(command, shards));
    EXPECT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(contents(path("table.json")), whole) << shards;
  }
  EXPECT_EQ(fathom("merge table.json 7.json 3.json 1.json 5.json 2.json 6.json 4.json").status, 0);
  EXPECT_EQ(contents(path("table.json")), whole);
}

TEST_F(Shards, OfOneStackAreItsPages) {
  std::vector<RawPage> pages;
  for (int page = 0; page < 5; ++page) {
    std::string pixels;
    for (int i = 0; i < 64 * 64; ++i) pixels += static_cast<char>((i * (page + 3)) % 251);
    pages.push_back({.width = 64, .height = 64, .pixels = pixels});
  }
  write("stack.tif", raw_tiff(pages));
  const std::string command = "stack.tif --page all --metric fft:64:none:power:rings=3";
  const std::string names = run(command, 3);
  EXPECT_EQ(lines("1.json").size(), 2u);  // one page, and the shard's last line
  EXPECT_EQ(fathom("merge table.json" + names).status, 0);
  EXPECT_EQ(contents(path("table.json")), alone(command));
  EXPECT_EQ(fathom("merge table.csv" + names).status, 0);
  const auto table = lines("table.csv");
  ASSERT_EQ(table.size(), 6u);
  EXPECT_EQ(table[0], "image,page,x,y,n,metric,backend,scores_1,scores_2,scores_3");
}

TEST_F(Shards, WithABadPictureReachTheirEndAndSayIt) {
  write_pictures(2);
  write("bad.pgm", "P5 no");
  const std::string names = run("bad.pgm p0.pgm p1.pgm", 3);
  const Outcome merged = fathom("merge table.json" + names);
  EXPECT_EQ(merged.status, 1);
  EXPECT_NE(merged.err.find("one picture or stack could not be read"), std::string::npos)
      << merged.err;
  EXPECT_EQ(contents(path("table.json")), alone("bad.pgm p0.pgm p1.pgm"));
}

/// Each stack has a folder, and the shards together what each alone would have.
TEST_F(Shards, OfStacksMapEachOnceAndMerge) {
  for (const std::string name : {"a", "b", "c"}) {
    std::vector<RawPage> pages;
    for (int page = 0; page < 4; ++page) {
      std::string pixels;
      for (int i = 0; i < 64 * 64; ++i) pixels += static_cast<char>((i * (page + 3)) % 251);
      pages.push_back({.width = 64, .height = 64, .pixels = pixels});
    }
    write(name + ".tif", raw_tiff(pages));
  }
  write("bad.tif", "II no");
  const std::string stacks = "a.tif b.tif bad.tif c.tif --json -o maps";
  std::string names;
  for (const std::string number : {"1", "2", "3"}) {
    write(number + ".json", fathom("depth " + stacks + " --shard " + number + "/3").out);
    names += " " + number + ".json";
  }
  const Outcome merged = fathom("merge table.csv" + names);
  EXPECT_EQ(merged.status, 1);
  EXPECT_NE(merged.err.find("one picture or stack could not be read"), std::string::npos);
  const auto table = lines("table.csv");
  ASSERT_EQ(table.size(), 4u);
  EXPECT_EQ(table[0].rfind("stack,folder,frames,unit,known", 0), 0u) << table[0];
  EXPECT_EQ(table[1].rfind("a.tif,maps/a,4,frames,", 0), 0u) << table[1];
  EXPECT_EQ(fathom("depth --rig replay:b.tif -o alone").status, 0);
  EXPECT_EQ(contents(path("maps/b/depth.tif")), contents(path("alone/depth.tif")));
  expect_refusal("depth a.tif b/a.tif --json", 2, {"a.tif", "b/a.tif", "both be mapped in"});
  expect_refusal("depth a.tif --shard 1/2", 2, {"--json"});
  expect_refusal("depth --rig replay:a.tif --shard 1/2", 2, {"--shard", "stacks"});
  expect_refusal("depth", 2, {"--rig", "stacks"});
}

TEST_F(Shards, NumbersInCsvAndNamesReadBack) {
  write_picture(path("a,\"b\".pgm"), picture(64, 64, 1));
  write("1.json", fathom("score 'a,\"b\".pgm' --json --shard 1/1").out);
  EXPECT_EQ(fathom("merge table.csv 1.json").status, 0);
  const auto table = lines("table.csv");
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table[1].rfind("\"a,\"\"b\"\".pgm\",0,0,0,64,fft:64:hann,", 0), 0u) << table[1];
  const double score = fathom("score 'a,\"b\".pgm' --json").lines().at(0).at("score");
  EXPECT_EQ(std::stod(table[1].substr(table[1].rfind(',') + 1)), score);
}

TEST_F(Shards, ThatAreMissingTwiceOrCutOffAreRefused) {
  write_pictures(4);
  const std::string names = run("p0.pgm p1.pgm p2.pgm p3.pgm --grid 16", 4);
  const std::string second = contents(path("2.json"));
  write("copy.json", second);
  write("half.json", second.substr(0, second.size() / 2));
  write("no-end.json", second.substr(0, second.rfind("{\"shard\"")));
  write("fewer.json", second.substr(second.find('\n') + 1));
  write("other.json", fathom("score p0.pgm p1.pgm p2.pgm p3.pgm --json --shard 2/4").out);
  write("text.json", "no rows\n");
  write("empty.json", "");
  expect_refusal("merge t.json 1.json 3.json", 1, {"2 of 4 shards are missing: 2, 4"});
  expect_refusal("merge t.json" + names + " copy.json", 1, {"2.json", "copy.json", "shard 2 of 4"});
  expect_refusal("merge t.json 1.json half.json", 1, {"half.json", "cut off"});
  expect_refusal("merge t.json 1.json no-end.json", 1, {"no-end.json", "no last line of a shard"});
  expect_refusal("merge t.json no-end.json 1.json", 1, {"no-end.json", "no last line of a shard"});
  expect_refusal("merge t.json 1.json fewer.json", 1, {"fewer.json", "rows are missing"});
  expect_refusal("merge t.json 1.json other.json", 1, {"other.json", "another run than 1.json"});
  expect_refusal("merge t.json text.json", 1, {"text.json", "line 1 is no JSON"});
  expect_refusal("merge t.json empty.json", 1, {"empty.json", "it is empty"});
  expect_refusal("merge" + names, 2, {"1.json is a part itself"});
  EXPECT_EQ(contents(path("t.json")), "");
  EXPECT_EQ(contents(path("2.json")), second);
}

TEST_F(Shards, PartsWithoutShardsMergeInTheirOrderButNothingTwice) {
  write_pictures(2);
  write("b.json", alone("p1.pgm"));
  write("a.json", alone("p0.pgm"));
  EXPECT_EQ(fathom("merge t.json b.json a.json").status, 0);
  EXPECT_EQ(contents(path("t.json")), alone("p1.pgm p0.pgm"));
  expect_refusal("merge t.json a.json a.json", 1, {"line 1 is there twice", "a.json"});
}

TEST_F(Shards, AreAskedForInOneForm) {
  write_pictures(1);
  for (const std::string shard :
       {"0/3", "4/3", "1", "1/", "/3", "a/b", "1/3/5", "-1/3", "1/9999999"})
    expect_refusal("score p0.pgm --json --shard " + shard, 2, {"--shard " + shard, "I/N"});
  expect_refusal("score p0.pgm --shard 1/2", 2, {"--json"});
}

}  // namespace
}  // namespace fathom::test
