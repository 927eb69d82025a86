// SPDX-License-Identifier: Apache-2.0
#include "bench/flows.hpp"

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <vector>

#include "backends/backends.hpp"
#include "bench/scene.hpp"
#include "engine/selection.hpp"
#include "pictures/picture.hpp"
#include "session/rehearsal.hpp"

extern char** environ;

namespace fathom::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 64;

struct Timed {
  std::string name;
  bool is_software = false;  ///< A GPU's kernels on a processor: a hundred times slower, or so.
};

/// The backends' first devices that a user would time: the oracle is none.
std::vector<Timed> devices() {
  std::vector<Timed> timed;
  for (const Backend* backend : all_backends()) {
    if (backend->name() == std::string("reference")) continue;
    const auto infos = backend->devices();
    if (!infos.empty()) {
      timed.push_back({backend->name(), infos[0].kind == DeviceKind::software});
    }
  }
  return timed;
}

std::vector<MetricSpec> metrics(int n) {
  return {MetricSpec::standard(Transform::fft, n),
          MetricSpec::standard(Transform::walsh_sequency, n)};
}

using Body = std::function<void(benchmark::State&)>;

/// On the wall: what is waited for is not always this thread's work. An exception is the
/// benchmark's error.
void add(const std::string& name, Body body) {
  benchmark::RegisterBenchmark(name.c_str(), [body = std::move(body)](benchmark::State& state) {
    try {
      body(state);
    } catch (const std::exception& error) {
      state.SkipWithError(error.what());
    }
  })->UseRealTime();
}

void count_windows(benchmark::State& state, std::size_t a_round) {
  const auto scored = static_cast<double>(state.iterations()) * static_cast<double>(a_round);
  using benchmark::Counter;
  state.counters["per_window"] = Counter(scored, Counter::kIsRate | Counter::kInvert);
}

Selection open(const std::string& device, const MetricSpec& spec, int threads = 1) {
  return select_device(all_backends(), device, spec, 1, {.threads = threads});
}

void latency_warm(benchmark::State& state, const std::string& device, const MetricSpec& spec) {
  const Selection selection = open(device, spec);
  const auto plan = selection.device->plan(spec, 1);
  const Frame frame = random_frame();
  const auto windows = scattered_windows(spec.n, 64);
  std::size_t next = 0;
  for (auto _ : state) {
    double score = plan->score(frame, windows[next++ % windows.size()]);
    benchmark::DoNotOptimize(score);
  }
  count_windows(state, 1);
}

void latency_cold(benchmark::State& state, const std::string& device, const MetricSpec& spec) {
  const Selection selection = open(device, spec);
  selection.device->plan(spec, 1);  // compiles
  const Frame frame = random_frame();
  const auto windows = scattered_windows(spec.n, 1);
  for (auto _ : state) {
    double score = selection.device->plan(spec, 1)->score(frame, windows[0]);
    benchmark::DoNotOptimize(score);
  }
  count_windows(state, 1);
}

/// Fresh frames, as a camera's; `in_flight` batches at a time.
void stream(benchmark::State& state, const std::string& device, const MetricSpec& spec,
            std::size_t batch, std::size_t in_flight) {
  const Selection selection = open(device, spec, 0);
  const auto plan = selection.device->plan(spec, batch);
  std::array<Frame, 4> frames;
  for (Frame& frame : frames) frame = random_frame();
  const auto windows = scattered_windows(spec.n, batch);
  struct Seat {
    std::vector<double> scores;
    Plan::Ticket ticket;
  };
  std::vector<Seat> seats(in_flight);
  for (Seat& seat : seats) seat.scores.resize(batch);
  std::size_t number = 0;
  const auto submit = [&] {
    Seat& seat = seats[number % in_flight];
    seat.ticket = plan->submit(frames[number % frames.size()], windows, seat.scores);
    ++number;
  };
  while (number < in_flight) submit();  // so that the clock sees a pipeline that is full
  for (auto _ : state) {
    plan->wait(seats[number % in_flight].ticket);
    submit();
  }
  for (Seat& seat : seats) plan->wait(seat.ticket);
  count_windows(state, batch);
}

void search(benchmark::State& state, const std::string& device, const std::string& metric) {
  RigOptions options;
  options.rig = "sim";
  options.metric = metric;
  options.backend = device;
  Rig rig(options);
  Rehearsal rehearsal(rig, {});
  std::size_t evaluations = 0;
  for (auto _ : state) {
    Focus focus = rehearsal.run();
    evaluations = focus.evaluations.size();
    benchmark::DoNotOptimize(focus);
  }
  state.counters["evaluations"] = static_cast<double>(evaluations);
}

/// A picture for the program, as long as this process lives.
const fs::path& picture() {
  struct File {
    File() : path(fs::temp_directory_path() / fmt::format("fathom-bench-{}.pgm", ::getpid())) {
      write_picture(path, random_frame());
    }
    ~File() {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
    fs::path path;
  };
  static const File file;
  return file.path;
}

/// Runs a program with its output thrown away. Throws std::runtime_error.
void run_program(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int problem =
      posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 1;
  if (problem == 0) waitpid(child, &status, 0);
  if (problem != 0 || status != 0) throw std::runtime_error(words[0] + " did not score");
}

void start(benchmark::State& state, const std::string& program, const std::string& device,
           const MetricSpec& spec) {
  const std::vector<std::string> words = {program,     "score",    "--backend",
                                          device,      "--metric", spec.text(),
                                          "--threads", "1",        picture().string()};
  run_program(words);  // compiles, and reads the program
  for (auto _ : state) run_program(words);
}

/// Windows of a frame of that width; threads: 0 for all.
void growth(benchmark::State& state, const std::string& device, const MetricSpec& spec,
            std::size_t count, int width, int threads) {
  const Selection selection = open(device, spec, threads);
  const auto plan = selection.device->plan(spec, count);
  const int height = width * 3 / 4;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint8_t>(i * 2654435761U >> 13);
  }
  const Frame frame(width, height, std::move(pixels));
  std::vector<Window> windows;
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<int>(i % 65536);
    windows.push_back({k * 37 % (width - spec.n + 1), k * 23 % (height - spec.n + 1), spec.n});
  }
  std::vector<double> scores(count);
  for (auto _ : state) plan->score(frame, windows, scores);
  count_windows(state, count);
}

void add_growth(const Timed& timed, const MetricSpec& spec) {
  const std::string& device = timed.name;
  const std::size_t most = timed.is_software ? 1024 : 16384;
  const std::string base = fmt::format("growth/{}/{}", device, spec.text());
  for (std::size_t windows = 1; windows <= most; windows *= 4) {
    add(fmt::format("{}/windows:{}", base, windows),
        [=](benchmark::State& state) { growth(state, device, spec, windows, 1024, 1); });
  }
  for (int width = 256; width <= 8192; width *= 2) {
    add(fmt::format("{}/frame:{}", base, width),
        [=](benchmark::State& state) { growth(state, device, spec, 64, width, 1); });
  }
  if (device != "cpu") return;
  for (int threads = 1; threads <= open(device, spec, 0).device->threads(); threads *= 2) {
    add(fmt::format("{}/threads:{}", base, threads),
        [=](benchmark::State& state) { growth(state, device, spec, 16384, 1024, threads); });
  }
}

}  // namespace

void add_flows(const std::string& program) {
  const bool has_program = ::access(program.c_str(), X_OK) == 0;
  if (!has_program) {
    fmt::print(stderr, "fathom_bench: NO start/: there is no program {}\n", program);
  }
  for (const Timed& timed : devices()) {
    const std::string& device = timed.name;
    const std::size_t batch = timed.is_software ? 256 : batch_size(kSide);
    for (const MetricSpec& spec : metrics(kSide)) {
      const std::string who = device + "/" + spec.text();
      const auto with = [&](auto body) {
        return [=](benchmark::State& state) { body(state, device, spec); };
      };
      add("latency/" + who + "/warm", with(latency_warm));
      add("latency/" + who + "/cold", with(latency_cold));
      if (has_program) {
        add("start/" + who, [=](benchmark::State& state) { start(state, program, device, spec); });
      }
      const std::string stream_name = fmt::format("stream/{}/batch:{}", who, batch);
      add(stream_name, [=](benchmark::State& state) { stream(state, device, spec, batch, 2); });
      add(stream_name + "/one",
          [=](benchmark::State& state) { stream(state, device, spec, batch, 1); });
      add("search/" + who, [=](benchmark::State& state) { search(state, device, spec.text()); });
      add_growth(timed, spec);
    }
  }
}

}  // namespace fathom::bench
