// SPDX-License-Identifier: Apache-2.0
// One thread has the rig. It takes orders, and shows what the camera sees between them.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/error.hpp"
#include "serve/lent_hardware.hpp"
#include "serve/live_scores.hpp"
#include "serve/procedures.hpp"
#include "serve/publisher.hpp"

namespace fathom::serve {

struct OperatorOptions {
  RigOptions rig;  ///< Its stop requests end a measurement that is under way.
  std::string search = "auto";
  std::filesystem::path folder;  ///< Below which everything is written.
  std::string version;           ///< Of the program.
  bool is_read_only = false;     ///< Only told; who may order is the service's affair.
};

/// The rig is at something else. Try again when it is done.
class Busy : public Error {
 public:
  explicit Busy(std::string_view message) : Error(ErrorCode::unavailable, message) {}
};

/// A frame that was taken for one program alone.
struct TakenFrame {
  Frame frame;
  std::optional<double> position;  ///< Where the lens stood, where that is known.
  FrameCounts counts;
};

/// A move of the lens that a program follows.
struct LensMove {
  int id = 0;
  bool is_done = false;
  Arrival arrival = {};   ///< Where it was done, and nothing failed.
  int recorded_here = 1;  ///< Pictures that a recording has of that place.
  std::optional<Error> failure = {};
};

class Operator {
 public:
  /// Opens the rig. Throws as open_hardware, and as LiveScores for window and metric.
  Operator(OperatorOptions options, Publisher& publisher);
  Operator(const Operator&) = delete;
  Operator& operator=(const Operator&) = delete;
  ~Operator() { finish(); }

  /// Stops what is measured, as stop() does, and waits until the lens is back and the run is kept.
  /// Nothing can be ordered afterwards.
  void finish();

  // What follows may be called from any thread. Each throws Busy where the rig is at something that
  // does not go together with it.

  /// Begins a measurement and returns its number. Throws Error(bad_argument) for what can be known
  /// to be wrong already.
  int start(Order order);
  /// Throws as LiveScores, and Error(bad_argument) for an unknown search; nothing is changed then.
  void set_windows(std::vector<Window> windows);
  void set_methods(const std::optional<std::string>& metric,
                   const std::optional<std::string>& search);
  /// Sends the lens to the nearest position that it has. The newest wish counts. Throws
  /// Error(out_of_bounds) or Error(bad_argument).
  void move_lens(double position);
  /// From where it stands, or is being sent.
  void move_lens_by(double change);
  /// To a calibration that waits.
  void next_step(const NextStep& step);

  // For a program that has the rig as its own (docs/http.md). Each waits for the rig's thread, and
  // throws what the rig does.

  /// The rig as JSON: camera, lens, whether there is a stage.
  std::string rig_facts();
  /// The camera's next frame, or nothing within the timeout.
  std::optional<TakenFrame> take(std::chrono::milliseconds timeout);
  double lens_position();
  /// Sends the lens to a position, or home without one; returns the number of the move. Throws Busy
  /// while another is under way.
  int begin_move(std::optional<double> position);
  /// How it stands, once it is done or the time is over. Throws Error(bad_argument) for any but the
  /// newest.
  LensMove moved(int id, std::chrono::milliseconds timeout);
  /// Distance of what a place in the picture shows, or of the target, mm. This and the next throw
  /// Error(unsupported) without a stage.
  double stage_distance(std::optional<std::pair<double, double>> place_px);
  void place_target(double distance_mm);

  /// Ends what is being measured or moved; the lens goes back. Once more, a second later or more, ends
  /// that too.
  void stop();

 private:
  using Task = std::function<void()>;

  // On any thread.
  void require_idle() const;
  void push(Task task);
  /// What it makes of the rig; it holds all that it needs itself.
  template <typename Work>
  auto on_rig(Work work);
  void aim(const std::string& metric, std::vector<Window> windows);
  void check(const Order& order) const;
  int requests() const;

  // On the rig's thread.
  void work();
  std::optional<Task> next_task();
  std::shared_ptr<LiveScores> scores();
  void open();
  void describe();
  void show_live();
  void grab_live();
  void lose(const Error& error);
  void reopen();
  void seen(const Frame& frame);
  void show(const Frame& frame, std::optional<double> position, bool is_settled);
  void tell_scores(const Frame& frame, std::optional<double> position, bool is_settled);
  void tell_place(const std::function<void(State&)>& change);
  void departed();
  void arrived(const std::optional<Arrival>& arrival);
  void carry_out_order(const Order& order, int id, int stops_before);
  void take_window(const Window& window);
  void end(const Order& order, int id, const Ending& ending);
  void go_to_wanted(int stops_before);
  Arrival travel_to(double to);
  LensMove carry_out_move(int id, std::optional<double> to);
  TargetStage& stage();
  bool has_other_wish() const;
  NextStep wait_for_step();

  // On a thread of its own.
  void analyse();
  void tell_frame(const Picture& picture, double per_s);
  void tell_spectrum(const Picture& picture);

  OperatorOptions options_;
  Publisher& publisher_;

  std::atomic<int> stops_ = 0;         // asked for so far,
  std::atomic<int> stops_before_ = 0;  // and before what is done now
  std::atomic<bool> is_ending_ = false;

  mutable std::mutex mutex_;
  std::condition_variable wakes_;
  std::deque<Task> tasks_;
  bool is_busy_ = false;  // with an order
  int orders_ = 0;
  bool has_stopped_ = false;      // the order that is under way,
  std::int64_t stopped_ns_ = 0;   // and when
  std::optional<double> wanted_;  // where the lens is to go
  bool is_sent_ = false;          // a task for that waits, or is done now
  std::optional<NextStep> step_;
  bool is_waiting_ = false;         // for a step
  LensMove move_{.is_done = true};  // the newest that a program follows

  std::mutex scores_mutex_;  // of this pointer alone
  std::shared_ptr<LiveScores> scores_;

  std::optional<LentHardware> hardware_;
  Hardware eyes_;  // what live pictures are taken with: lent too, so that they are seen
  bool is_moving_ = false;
  std::int64_t settled_ns_ = 0;    // on the rig's clock,
  std::int64_t shown_ns_ = 0;      // on this computer's: when the last picture was shown,
  std::int64_t next_live_ns_ = 0;  // and when the next one is due
  std::int64_t retry_ns_ = 0;
  std::int64_t taken_ns_ = 0;  // when a program asked for a frame last
  int most_grey_ = 255;        // of the camera, as far as was seen

  std::thread analyst_;
  std::thread thread_;
};

}  // namespace fathom::serve
