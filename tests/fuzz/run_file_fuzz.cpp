// SPDX-License-Identifier: Apache-2.0
// A record that was read is written and read back the same, and replays to an answer or an Error.
#include "fuzz.hpp"
#include "session/run_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  RunFile record;
  if (!fuzz::accepted([&] { record = RunFile::parse(fuzz::text_of(data, size), "r.json"); })) {
    return 0;
  }
  const std::string json = record.json();
  fuzz::require(RunFile::parse(json, "r.json").json() == json, "a record comes back as it was");
  fuzz::accepted([&] { replay(record, "record"); });
  return 0;
}
