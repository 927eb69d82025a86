// SPDX-License-Identifier: Apache-2.0
#include "hal/whereabouts.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "engine/file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

const Owner owner{"port, 0 to 1200", -10, 1200, 8};

class WhereaboutsFile : public testing::Test {
 protected:
  /// Why a file with this text is not believed; empty if it is.
  std::string doubt(const std::string& text) {
    write_file(path, text);
    const Whereabouts read(path, owner);
    return read.standing() ? "" : read.reason();
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder / "deep/state.json";
};

TEST_F(WhereaboutsFile, AreUnknownAtFirst) {
  const Whereabouts fresh(path, owner);
  EXPECT_FALSE(fresh.standing());
  EXPECT_NE(fresh.reason().find(path.string()), std::string::npos);
}

TEST_F(WhereaboutsFile, AreKnownToTheNextRunAfterAMoveThatEnded) {
  for (const Standing standing :
       {Standing{700, true}, Standing{-10, false}, Standing{1200, true}}) {
    {
      Whereabouts first(path, owner);
      first.leave("moving from 0 to 700");
      first.arrive(standing);
      EXPECT_EQ(first.standing(), standing);
    }
    EXPECT_EQ(Whereabouts(path, owner).standing(), standing);
  }
}

TEST_F(WhereaboutsFile, AreUnknownToTheNextRunAfterAMoveThatDidNot) {
  {
    Whereabouts first(path, owner);
    first.arrive({0, true});
    first.leave("moving from 0 to 700");
    EXPECT_FALSE(first.standing());
    EXPECT_NE(first.reason().find("moving from 0 to 700"), std::string::npos);
  }
  const Whereabouts second(path, owner);
  EXPECT_FALSE(second.standing());
  EXPECT_NE(second.reason().find("cut off while moving from 0 to 700"), std::string::npos);
}

TEST_F(WhereaboutsFile, OfAnotherMotorAreNotBelieved) {
  {
    Whereabouts first(path, owner);
    first.arrive({700, true});
  }
  Owner other = owner;
  other.motor = "port, 0 to 900";
  const Whereabouts second(path, other);
  EXPECT_FALSE(second.standing());
  EXPECT_NE(second.reason().find("another motor or travel: port, 0 to 1200"), std::string::npos);
}

TEST_F(WhereaboutsFile, WithOtherBacklashAreBelievedButNotTheApproach) {
  {
    Whereabouts first(path, owner);
    first.arrive({700, true});
  }
  Owner other = owner;
  other.backlash = 9;
  EXPECT_EQ(Whereabouts(path, other).standing(), (Standing{700, false}));
}

TEST_F(WhereaboutsFile, OfADamagedFileAreNotBelieved) {
  {
    Whereabouts first(path, owner);
    first.arrive({700, true});
  }
  const std::string whole = read_file(path);
  EXPECT_EQ(doubt(whole), "");
  const std::size_t closing = whole.rfind('}');
  for (std::size_t length = 0; length <= closing; ++length) {
    EXPECT_NE(doubt(whole.substr(0, length)), "") << length;
  }
  const auto with = [&](const std::string& old, const std::string& now) {
    std::string changed = whole;
    EXPECT_NE(whole.find(old), std::string::npos) << old;
    return changed.replace(whole.find(old), old.size(), now);
  };
  for (const char* position : {"700.5", "1201", "-11", "\"700\"", "null", "1e99", "4294967996",
                               "18446744073709551615", "true", "[]"}) {
    EXPECT_NE(doubt(with("700", position)), "") << position;
  }
  EXPECT_NE(doubt(with("true", "1")), "");
  EXPECT_NE(doubt(with("\"version\": 1", "\"version\": 2")), "");
  EXPECT_NE(doubt(with("fathom-lens-position", "something")), "");
  EXPECT_NE(doubt(with("\"motor\"", "\"rotor\"")), "");
  EXPECT_NE(doubt(with("\"port, 0 to 1200\"", "7")), "");
  EXPECT_NE(doubt(with("\"position\"", "\"doing\": 3, \"position\"")), "");
  for (const char* text : {"", "[]", "null", "7", "{}", "\xff\xfe", "[[[[[[[["}) {
    EXPECT_NE(doubt(text), "") << text;
  }
}

TEST_F(WhereaboutsFile, ThatCannotBeReadAreAnError) {
  std::filesystem::create_directories(path);
  expect_error(ErrorCode::io, [&] { Whereabouts(path, owner); }, {"state.json"});
  std::filesystem::remove(path);
  write_file(path, std::string(100'000, ' '));
  expect_error(ErrorCode::bad_data, [&] { Whereabouts(path, owner); }, {"state.json"});
}

TEST_F(WhereaboutsFile, BelongToOneAtATime) {
  const Whereabouts first(path, owner);
  const std::string number = std::to_string(::getpid());
  expect_error(ErrorCode::unavailable, [&] { Whereabouts(path, owner); },
               {"in use by process", number.c_str(), "port, 0 to 1200", "state.json.lock"});
}

TEST_F(WhereaboutsFile, AreFreeAgainAfterwards) {
  { const Whereabouts first(path, owner); }
  EXPECT_NO_THROW(Whereabouts(path, owner));
}

TEST_F(WhereaboutsFile, ThatCannotBeWrittenChangeNothing) {
  Whereabouts whereabouts(path, owner);
  whereabouts.arrive({700, true});
  std::filesystem::remove(path);
  std::filesystem::create_directories(path);  // nobody, not even root, can write that
  expect_error(ErrorCode::io, [&] { whereabouts.leave("moving"); });
  EXPECT_EQ(whereabouts.standing(), (Standing{700, true}));
}

TEST_F(WhereaboutsFile, NeedAPlaceForTheirLock) {
  write_file(folder / "file", "");
  expect_error(ErrorCode::io, [&] { Whereabouts(folder / "file/state.json", owner); },
               {"file/state.json.lock", "state = PATH"});
}

/// Puts a variable back at the end.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    value != nullptr ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Environment() { old_ ? ::setenv(name_, old_->c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> old_;
};

TEST(StepperStatePath, IsUnderTheUsersStateAndNamedAfterTheLines) {
  const Environment state("XDG_STATE_HOME", "/state");
  EXPECT_EQ(default_state_path("gpiochip0 (cp210x), step line 0, direction line 1"),
            "/state/fathom/lenses/gpiochip0-cp210x-step-line-0-direction-line-1.json");
}

TEST(StepperStatePath, IsUnderHomeElsewhere) {
  const Environment home("HOME", "/home/me");
  for (const char* nothing : {static_cast<const char*>(nullptr), "", "relative"}) {
    const Environment state("XDG_STATE_HOME", nothing);
    EXPECT_EQ(default_state_path("a/../b"), "/home/me/.local/state/fathom/lenses/a-b.json");
  }
}

TEST(StepperStatePath, IsAskedForWhereThereIsNoHome) {
  const Environment state("XDG_STATE_HOME", nullptr);
  for (const char* nothing : {static_cast<const char*>(nullptr), "", "relative"}) {
    const Environment home("HOME", nothing);
    expect_error(ErrorCode::unavailable, [] { default_state_path("port"); },
                 {"HOME", "state = PATH"});
  }
}

}  // namespace
}  // namespace fathom::test
