// SPDX-License-Identifier: Apache-2.0
#include "port_log.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace fathom::test {
namespace {

std::string log_path() {
  const char* const share = std::getenv("FATHOM_SHARE");
  return share == nullptr ? "" : std::string(share) + "/parallel.log";
}

}  // namespace

PortLog::PortLog() {
  std::ifstream log(log_path(), std::ios::ate);
  is_there_ = log.good();
  if (is_there_) begin_ = log.tellg();
}

std::vector<PortWrite> PortLog::writes() const {
  std::ifstream log(log_path());
  log.seekg(begin_);
  std::vector<PortWrite> writes;
  for (std::string line; std::getline(log, line);) {
    double time_s = 0;
    unsigned address = 0, data = 0;
    const char* const format = "%*d@%lf:parallel_ioport_write write [SW] addr %x val %x";
    if (std::sscanf(line.c_str(), format, &time_s, &address, &data) != 3 || address != 0) continue;
    writes.push_back({time_s, static_cast<std::uint8_t>(data)});
  }
  return writes;
}

}  // namespace fathom::test
