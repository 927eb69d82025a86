// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/suite.hpp"

#include <errno.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t start = 0;
  for (std::size_t end; (end = text.find(separator, start)) != std::string::npos; start = end + 1) {
    parts.push_back(text.substr(start, end - start));
  }
  parts.push_back(text.substr(start));
  return parts;
}

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// FATHOM_CONFORMANCE: DEVICE/SPEC/PICTURE/seed=S.
struct Filter {
  std::vector<std::string> parts = split(environment("FATHOM_CONFORMANCE"), '/');

  bool is_set() const { return parts.size() > 1 || !parts[0].empty(); }
  bool accepts(std::size_t part, const std::string& value) const {
    return !is_set() || part >= parts.size() || parts[part] == "*" || parts[part] == value;
  }
  bool accepts_device(const std::string& label) const { return accepts(0, label); }
  bool accepts_case(const Case& tested) const {
    const auto texts = split(tested.text(), '/');
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (!accepts(i + 1, texts[i])) return false;
    }
    return parts.size() <= texts.size() + 1;
  }
};

const Filter& filter() {
  static const Filter parsed;
  return parsed;
}

/// What the run did, told at its end, because a skip that nobody sees is a hole in the suite.
class Report : public ::testing::Environment {
 public:
  std::size_t cases_run = 0;
  std::map<std::string, std::set<std::string>> declined;   ///< "LABEL: REASON" -> metrics
  std::set<std::string> absent;                            ///< backends without a device, and why
  std::map<std::string, std::shared_ptr<Device>> devices;  ///< opened once, closed before exit

  void TearDown() override {
    devices.clear();
    for (const auto& [who, specs] : declined) {
      fmt::print("[ DECLINED ] {} metrics by {}: {}\n", specs.size(), who, fmt::join(specs, " "));
    }
    for (const std::string& backend : absent) fmt::print("[ ABSENT   ] {}\n", backend);
    fmt::print("[ CASES    ] {}\n", cases_run);
    if (filter().is_set() && cases_run == 0) {
      ADD_FAILURE() << "FATHOM_CONFORMANCE=" << environment("FATHOM_CONFORMANCE")
                    << " selects no case of the tests that ran";
    }
  }
};

// GoogleTest owns it and calls TearDown after the last test.
Report& report() {
  static auto* const environment = new Report;
  return *environment;
}
const ::testing::Environment* const registered = ::testing::AddGlobalTestEnvironment(&report());

std::string repeat_command(const DeviceUnderTest& device, const Case& tested) {
  const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
  return fmt::format("FATHOM_CONFORMANCE='{}/{}' {} --gtest_filter='{}.{}'", device.label(),
                     tested.text(), program_invocation_name, test->test_suite_name(), test->name());
}

}  // namespace

std::string DeviceUnderTest::label() const { return fmt::format("{}:{}", backend->name(), index); }

bool DeviceUnderTest::is_reference() const { return backend->name() == std::string("reference"); }

void PrintTo(const DeviceUnderTest& device, std::ostream* out) {
  *out << device.label() << " (" << device.info.name << ")";
}

const std::vector<DeviceUnderTest>& devices_under_test() {
  static const auto devices = [] {
    std::vector<DeviceUnderTest> found;
    for (const Backend* backend : all_backends()) {
      const auto infos = backend->devices();
      for (std::size_t i = 0; i < infos.size(); ++i) found.push_back({backend, i, infos[i]});
    }
    return found;
  }();
  return devices;
}

bool is_required(const std::string& backend_name) {
  const auto names = split(environment("FATHOM_REQUIRE_BACKENDS"), ',');
  return std::find(names.begin(), names.end(), backend_name) != names.end();
}

bool is_filtered() { return filter().is_set(); }

const char* golden_file() {
  const char* const elsewhere = std::getenv("FATHOM_GOLDEN_FILE");
  return elsewhere != nullptr ? elsewhere : FATHOM_GOLDEN_FILE;
}

std::string Case::text() const {
  return fmt::format("{}/{}{}/seed={}", spec.text(), content, bits, seed);
}

std::vector<Case> cases(const std::vector<std::string>& specs,
                        const std::vector<std::string>& pictures, std::uint64_t seed) {
  std::vector<Case> all;
  for (const std::string& spec : specs) {
    for (const std::string& picture : pictures) {
      const int bits = picture.ends_with("16") ? 16 : 8;
      const std::string content = picture.substr(0, picture.find_first_of("0123456789"));
      all.push_back({MetricSpec::parse(spec), content, bits, seed});
    }
  }
  return all;
}

void Conformance::SetUp() {
  const DeviceUnderTest& tested = GetParam();
  if (!filter().accepts_device(tested.label())) GTEST_SKIP() << "not selected";
  std::shared_ptr<Device>& device = report().devices[tested.label()];
  if (device == nullptr) {
    try {
      device = tested.backend->open(tested.index, {});
    } catch (const Error& error) {
      const std::string why = fmt::format("{} does not open: {}", tested.label(), error.what());
      report().absent.insert(why);
      ASSERT_EQ(error.code(), ErrorCode::unavailable) << why;
      ASSERT_FALSE(is_required(tested.backend->name())) << why;
      GTEST_SKIP() << "NOTHING IS TESTED HERE: " << why;
    }
  }
  device_ = device;
}

double Conformance::tolerance(const MetricSpec& spec) const {
  const double owed = test::score_tolerance(spec);
  return GetParam().is_reference() ? std::min(owed, 1e-12) : owed;
}

void Conformance::each(const std::vector<Case>& cases, std::size_t capacity, const Body& body) {
  const std::string label = GetParam().label();
  std::size_t run = 0, selected = 0;
  for (const Case& tested : cases) {
    if (!filter().accepts_case(tested)) continue;
    ++selected;
    const std::string reason = device_->unsupported(tested.spec);
    if (!reason.empty()) {
      EXPECT_FALSE(GetParam().is_reference()) << "the oracle must take " << tested.spec.text();
      report().declined[label + ": " + reason].insert(tested.spec.text());
      continue;
    }
    SCOPED_TRACE("repeat: " + repeat_command(GetParam(), tested));
    ++run;
    ++report().cases_run;
    try {
      body(tested, *device_->plan(tested.spec, capacity));
    } catch (const std::exception& error) {
      ADD_FAILURE() << "threw: " << error.what();
    }
    if (HasFatalFailure()) return;
  }
  if (filter().is_set()) {
    if (selected == 0) GTEST_SKIP() << "no case is selected";
    return;
  }
  EXPECT_GT(run, 0U) << label << " declined every case of this test";
}

std::unique_ptr<Plan> Conformance::oracle(const MetricSpec& spec, std::size_t capacity) {
  static const std::unique_ptr<Device> reference = [] {
    for (const Backend* backend : all_backends()) {
      if (backend->name() == std::string("reference")) return backend->open(0, {});
    }
    throw Error(ErrorCode::unavailable, "this build has no reference backend to compare with");
  }();
  return reference->plan(spec, capacity);
}

double Conformance::oracle_score(const Case& tested) {
  static std::map<std::string, double> known;
  const auto [entry, is_new] = known.try_emplace(tested.text());
  if (is_new) entry->second = oracle(tested.spec)->score(tested.frame(), {0, 0, tested.spec.n});
  return entry->second;
}

std::vector<std::string> typical_specs() {
  return {"fft:8:hann",
          "fft:16:none",
          "fft:32:tukey=0.25",
          "fft:64:hann",
          "fft:64:hann:power",
          "fft:32:hann:band=0-0.25",
          "walsh-paley:8",
          "walsh-sequency:64",
          "walsh-hadamard:32",
          "walsh-paley:16:power",
          "walsh-sequency:32:hann",
          "walsh-sequency:64:band=0-0.25",
          "dct:16:power",
          "dct:32:band=0.05-0.4",
          "dct:64:entropy",
          "dct:8:entropy:band=0-0.25"};
}

std::vector<std::string> large_specs() {
  return {"fft:128:hann",       "fft:256:none",         "walsh-sequency:128",
          "walsh-sequency:512", "walsh-paley:256:hann", "dct:128:entropy"};
}

}  // namespace fathom::conformance
