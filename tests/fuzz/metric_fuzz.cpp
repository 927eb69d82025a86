// SPDX-License-Identifier: Apache-2.0
// A metric's text is read back as the same metric and written as the same text.
#include "engine/metric.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  MetricSpec spec;
  if (!fuzz::accepted([&] { spec = MetricSpec::parse(fuzz::text_of(data, size)); })) return 0;
  spec.validate();
  const std::string text = spec.text();
  const MetricSpec back = MetricSpec::parse(text);
  fuzz::require(back == spec, "parse(text()) is the same metric");
  fuzz::require(back.text() == text, "the canonical text is one");
  return 0;
}
