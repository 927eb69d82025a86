// SPDX-License-Identifier: Apache-2.0
// What a careful user of CUDA would have without Fathom, timed at the same work: a kernel that
// widens and tapers, cuFFT (for Walsh a plain kernel, cuFFT has none), a kernel that reduces; and
// cuFFT with both kernels linked into its own as callbacks. And the card's ceilings. Prints the
// lines that fathom_gpu_throughput prints; bench/gpu/measure builds and runs it:
//
//   nvcc -O3 -std=c++17 --use_fast_math -arch=sm_90 -I ROOT cuda_peer.cu -o cuda_peer -lcufft
//   cuda_peer [--sides N,..] [--batches B,..] [--cell-seconds S] [--seconds S] [--callbacks FOLDER]
//
// FOLDER: with load.fatbin and store.fatbin (cuda_peer/load_callbacks.cu); without it cuFFT is
// timed plain.
#include "cuda_peer/callback_pipeline.cuh"
#include "cuda_peer/ceilings.cuh"
#include "cuda_peer/pipeline.cuh"
#include "cuda_peer/timing.cuh"

namespace fathom::peer {
namespace {

constexpr int kNoDevice = 77;

Peer plain_peer() {
  return {"peer", Pipeline::bytes_between,
          [](const Metric& metric, std::size_t windows, std::size_t chunk) {
            return std::make_unique<Pipeline>(metric, windows, chunk);
          }};
}

Peer callback_peer(const CallbackCode& code) {
  return {"peer-callbacks", CallbackPipeline::bytes_between,
          [&code](const Metric& metric, std::size_t windows, std::size_t chunk) {
            return std::make_unique<CallbackPipeline>(code, metric, windows, chunk);
          }};
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

/// The card, and until when it may be used.
struct Session {
  std::string device;
  std::size_t cache_bytes;
  double end_s;
};

/// How many cells failed.
std::size_t measure_all(const Peer& peer, const std::vector<Cell>& all, const Pixels& pixels,
                        const Options& options, const Session& session) {
  std::size_t failed = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (bench::seconds() > session.end_s) {
      std::fprintf(stderr, "cuda_peer: OUT OF TIME: %zu of %zu cells of %s are not measured\n",
                   all.size() - i, all.size(), peer.name.c_str());
      break;
    }
    failed += !measure_both(peer, pixels, all[i], session.cache_bytes, options, session.device);
  }
  return failed;
}

/// Those that cuFFT has a transform for.
std::vector<Cell> fourier(std::vector<Cell> all) {
  all.erase(
      std::remove_if(all.begin(), all.end(), [](const Cell& cell) { return cell.metric.is_walsh; }),
      all.end());
  return all;
}

/// Plain first: linking callbacks takes a while for each plan, and may be what time is short for.
std::size_t measure_peers(const Options& options, const Session& session) {
  const auto all = cells(options);
  std::size_t most = 0;
  for (const Cell& cell : all) most = std::max(most, cell.windows * cell.metric.window_bytes());
  const Pixels pixels(most);
  std::size_t failed = measure_all(plain_peer(), all, pixels, options, session);
  if (options.callbacks.empty()) return failed;
  const CallbackCode code(options.callbacks);
  return failed + measure_all(callback_peer(code), fourier(all), pixels, options, session);
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
  const Session session = {device, static_cast<std::size_t>(properties.l2CacheSize),
                           bench::seconds() + options.total_s};
  return measure_peers(options, session) > 0 ? 1 : 0;
}

}  // namespace
}  // namespace fathom::peer

int main(int argc, char** argv) try {
  return fathom::peer::run(fathom::peer::parse(argc, argv));
} catch (const std::exception& error) {
  std::fprintf(stderr, "cuda_peer: %s\n", error.what());
  return 1;
}
