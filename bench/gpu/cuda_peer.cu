// SPDX-License-Identifier: Apache-2.0
// What a careful user of CUDA would have without Fathom, timed at the same work: a kernel that
// widens and tapers, cuFFT (for Walsh a plain kernel, cuFFT has none), a kernel that reduces. And
// the card's ceilings. Prints the lines that fathom_gpu_throughput prints; bench/gpu/measure builds
// and runs it:
//
//   nvcc -O3 -std=c++17 --use_fast_math -arch=sm_90 -I ROOT cuda_peer.cu -o cuda_peer -lcufft
//   cuda_peer [--sides N,..] [--batches B,..] [--cell-seconds S] [--seconds S]
#include <cstring>
#include <sstream>

#include "cuda_peer/ceilings.cuh"
#include "cuda_peer/work.cuh"

namespace fathom::peer {
namespace {

constexpr int kNoDevice = 77;

/// Between the kernels of one pipeline: launches cost nothing at this size, and two pipelines and
/// cuFFT's own memory fit any card of a data centre.
constexpr std::size_t kMostBetween = std::size_t{2} << 30;

struct Options {
  std::vector<int> sides = bench::all_sides();
  std::vector<std::size_t> batches = bench::all_batches();
  double cell_s = 0.3;
  double total_s = 1e9;
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

Options parse(int argc, char** argv) {
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

std::vector<Cell> cells(const Options& options) {
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

void print_line(const char* what, const Cell& cell, const std::string& rest) {
  std::printf("{\"what\":\"%s\",\"metric\":\"%s\",\"depth\":%d,\"batch\":%zu,%s}\n", what,
              cell.metric.text().c_str(), cell.metric.depth, cell.batch, rest.c_str());
  std::fflush(stdout);  // a run that is cut off has lost nothing
}

bench::Times time_one(const Pixels& pixels, const Cell& cell, const Tiles& tiles, std::size_t chunk,
                      bool is_streamed, double budget_s) {
  Work work(pixels, cell.metric, tiles, chunk, is_streamed);
  work.step();
  work.step();
  work.land_and_check();
  const bench::Times times = bench::time_steps([&] { work.step(); }, budget_s);
  work.land_and_check();
  return times;
}

/// Large parts keep the card busy, small ones stay in its second-level cache: the faster counts.
void measure(const Pixels& pixels, const Cell& cell, std::size_t cache_bytes, bool is_streamed,
             const Options& options, const std::string& device) {
  const Tiles tiles(cell.metric, cell.windows);
  bench::Times best;
  std::size_t best_chunk = 0;
  for (const std::size_t bytes : {kMostBetween, cache_bytes / 2}) {
    const std::size_t chunk = Pipeline::chunk_for(cell.metric, cell.windows, bytes);
    if (chunk == best_chunk) continue;
    const auto times = time_one(pixels, cell, tiles, chunk, is_streamed, options.cell_s);
    if (best_chunk != 0 && best.median_s <= times.median_s) continue;
    best = times;
    best_chunk = chunk;
  }
  const double windows = static_cast<double>(cell.windows), us = 1e6 / windows;
  char rest[512];
  std::snprintf(rest, sizeof rest,
                "\"windows\":%zu,\"us_per_window\":%.9g,\"windows_per_s\":%.9g,\"min\":%.9g,"
                "\"median\":%.9g,\"max\":%.9g,\"repetitions\":%zu,\"chunk\":%zu,\"device\":\"%s\"",
                cell.windows, us * best.median_s, windows / best.median_s, us * best.min_s,
                us * best.median_s, us * best.max_s, best.repetitions, best_chunk, device.c_str());
  print_line(is_streamed ? "peer-streamed" : "peer-resident", cell, rest);
}

/// Whether both ways were measured.
bool measure_both(const Pixels& pixels, const Cell& cell, std::size_t cache_bytes,
                  const Options& options, const std::string& device) {
  for (const bool is_streamed : {false, true}) {
    try {
      measure(pixels, cell, cache_bytes, is_streamed, options, device);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "cuda_peer: NOT TIMED: %s of %d bits, batch %zu, %s: %s\n",
                   cell.metric.text().c_str(), cell.metric.depth, cell.batch,
                   is_streamed ? "streamed" : "resident", error.what());
      std::string why = error.what();
      std::replace(why.begin(), why.end(), '"', '\'');
      print_line("failed", cell,
                 std::string("\"doing\":\"peer-") + (is_streamed ? "streamed" : "resident") +
                     "\",\"why\":\"" + why + "\"");
      // After an error in a kernel nothing on the device works any more.
      PEER_CHECK(cudaDeviceSynchronize());
      cudaGetLastError();  // one that was reported, such as too little memory, is done with
      return false;
    }
  }
  return true;
}

void print_ceilings(int multiprocessors, const std::string& device) {
  const Ceilings ceilings = measure_ceilings(multiprocessors);
  std::printf(
      "{\"what\":\"ceilings\",\"copy_bytes_per_s\":%.6g,\"read_bytes_per_s\":%.6g,"
      "\"upload_bytes_per_s\":%.6g,\"flops\":%.6g,\"device\":\"%s\"}\n",
      ceilings.copy_bytes_per_s, ceilings.read_bytes_per_s, ceilings.upload_bytes_per_s,
      ceilings.flops, device.c_str());
  std::fflush(stdout);
}

int run(const Options& options) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
    std::fprintf(stderr, "cuda_peer: NOTHING IS TIMED: no CUDA device\n");
    return kNoDevice;
  }
  cudaDeviceProp properties = {};
  PEER_CHECK(cudaGetDeviceProperties(&properties, 0));
  int driver = 0, runtime = 0, cufft = 0;
  PEER_CHECK(cudaDriverGetVersion(&driver));
  PEER_CHECK(cudaRuntimeGetVersion(&runtime));
  PEER_CHECK(cufftGetVersion(&cufft));
  const std::string device = properties.name;
  std::printf("{\"what\":\"cuda\",\"name\":\"%s\",\"driver\":%d,\"runtime\":%d,\"cufft\":%d}\n",
              device.c_str(), driver, runtime, cufft);
  print_ceilings(properties.multiProcessorCount, device);
  const auto all = cells(options);
  std::size_t most = 0;
  for (const Cell& cell : all) most = std::max(most, cell.windows * cell.metric.window_bytes());
  const Pixels pixels(most);
  const double end = bench::seconds() + options.total_s;
  const auto cache_bytes = static_cast<std::size_t>(properties.l2CacheSize);
  std::size_t failed = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (bench::seconds() > end) {
      std::fprintf(stderr, "cuda_peer: OUT OF TIME: %zu of %zu cells are not measured\n",
                   all.size() - i, all.size());
      break;
    }
    failed += !measure_both(pixels, all[i], cache_bytes, options, device);
  }
  return failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace fathom::peer

int main(int argc, char** argv) try {
  return fathom::peer::run(fathom::peer::parse(argc, argv));
} catch (const std::exception& error) {
  std::fprintf(stderr, "cuda_peer: %s\n", error.what());
  return 1;
}
