// SPDX-License-Identifier: Apache-2.0
// What the command line asks for, and the cells that it comes to.
#pragma once

#include <sstream>

#include "bench/gpu/common.hpp"
#include "metric.cuh"

namespace fathom::peer {

struct Options {
  std::vector<int> sides = bench::all_sides();
  std::vector<std::size_t> batches = bench::all_batches();
  double cell_s = 0.3;
  double total_s = 1e9;
  std::string callbacks;  ///< The folder with load.fatbin and store.fatbin, or nothing.
};

template <class T>
std::vector<T> list(const char* text) {
  std::vector<T> values;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    values.push_back(static_cast<T>(std::stoul(part)));
  }
  return values;
}

inline Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i];
    if (i + 1 == argc) throw std::runtime_error(name + " wants a value");
    if (name == "--sides") {
      options.sides = list<int>(argv[i + 1]);
    } else if (name == "--batches") {
      options.batches = list<std::size_t>(argv[i + 1]);
    } else if (name == "--cell-seconds") {
      options.cell_s = std::stod(argv[i + 1]);
    } else if (name == "--seconds") {
      options.total_s = std::stod(argv[i + 1]);
    } else if (name == "--callbacks") {
      options.callbacks = argv[i + 1];
    } else {
      throw std::runtime_error("no option " + name);
    }
  }
  return options;
}

struct Cell {
  Metric metric;
  std::size_t batch;
  std::size_t windows;
};

inline std::vector<Cell> cells(const Options& options) {
  std::vector<Cell> all;
  for (const int n : options.sides) {
    std::vector<Metric> metrics = {{false, false, n, 8}, {true, false, n, 8}};
    if (n == 64) {
      metrics.insert(metrics.end(),
                     {{false, true, n, 8}, {false, false, n, 16}, {true, false, n, 16}});
    }
    for (const Metric& metric : metrics) {
      for (const std::size_t batch : options.batches) {
        const std::size_t most = bench::kMostFrameBytes / metric.window_bytes();
        all.push_back({metric, batch, std::min(batch, most)});
      }
    }
  }
  return all;
}

}  // namespace fathom::peer
