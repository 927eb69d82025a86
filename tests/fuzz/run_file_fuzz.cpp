// SPDX-License-Identifier: Apache-2.0
// A run file that was read is written and read back the same, and computes again to an answer or an
// Error.
#include "fuzz.hpp"
#include "session/run_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  RunFile file;
  if (!fuzz::accepted([&] { file = RunFile::parse(fuzz::text_of(data, size), "r.json"); })) {
    return 0;
  }
  const std::string json = file.json();
  fuzz::require(RunFile::parse(json, "r.json").json() == json, "a run file comes back as it was");
  fuzz::accepted([&] { rerun(file, "r.json"); });
  return 0;
}
