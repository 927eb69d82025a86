// SPDX-License-Identifier: Apache-2.0
// What opens cameras and lenses: one driver per kind of hardware, found by its name.
//
// A driver's folder holds its camera, its lens and what they share (a replayed stack, a simulated
// world, a connection to a server), because the two are rarely independent. A driver may give a
// camera, a lens or both: a rig file can put the camera of one driver and the lens of another
// together.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "camera.hpp"
#include "finding.hpp"
#include "lens.hpp"
#include "stop.hpp"

namespace fathom {

/// The key=value options of one driver. Reading marks a key as known; require_all_used() then
/// refuses the others, so that a mistyped key never passes in silence. Every getter throws
/// Error(bad_argument), naming the key, for a value that is not of its kind.
class RigSettings {
 public:
  RigSettings() = default;
  /// where: how error messages name the place, e.g. "sim" or "my-rig.toml [camera]".
  RigSettings(std::string where, std::map<std::string, std::string> values)
      : where_(std::move(where)), values_(std::move(values)) {}

  const std::string& where() const { return where_; }
  bool has(const std::string& key) const { return values_.contains(key); }
  void set(const std::string& key, const std::string& value) { values_[key] = value; }
  const std::map<std::string, std::string>& values() const { return values_; }

  std::string text(const std::string& key, const std::string& fallback) const;
  double number(const std::string& key, double fallback, double lowest, double highest) const;
  long long integer(const std::string& key, long long fallback, long long lowest,
                    long long highest) const;
  /// Nothing where the key is not there.
  std::optional<double> number_if_given(const std::string& key, double lowest,
                                        double highest) const;
  std::optional<int> integer_if_given(const std::string& key, int lowest, int highest) const;
  bool flag(const std::string& key, bool fallback) const;
  /// One of several words; the error lists them.
  std::string choice(const std::string& key, const std::string& fallback,
                     std::span<const std::string_view> words) const;

  /// Throws Error(bad_argument) for a key that no getter asked for, listing those that were.
  void require_all_used() const;

 private:
  const std::string* find(const std::string& key) const;

  std::string where_;
  std::map<std::string, std::string> values_;
  mutable std::set<std::string> known_;
};

/// Puts a target at a known distance, for calibration without a tape measure: simulated rigs have
/// one, real rigs do not, and the user is asked to move the target instead.
class TargetStage {
 public:
  virtual ~TargetStage() = default;
  /// Distance of the target from the lens, mm.
  virtual double distance_mm() const = 0;
  /// Of what a place in the picture shows, mm: the target's, for one that has no depth of its own.
  virtual double distance_mm(double /*x_px*/, double /*y_px*/) const { return distance_mm(); }
  /// Throws Error(out_of_bounds) for a distance that the stage cannot reach.
  virtual void place_at(double distance_mm) = 0;
};

/// What a driver opened. The members share what they need; they may be destroyed in any order.
struct Hardware {
  std::unique_ptr<Camera> camera;
  std::unique_ptr<Lens> lens;
  std::unique_ptr<TargetStage> stage;
  std::vector<Finding> findings = {};  ///< What was noticed on opening, in the order of telling.
};

/// What is wanted of a driver when it opens.
struct OpenOptions {
  bool camera = true;  ///< Whether a camera is wanted; what is not wanted is not touched,
  bool lens = true;    ///< for another driver or another program may hold it.
  StopRequests stop_requests = never_stop;  ///< Ends a move or an exposure that is under way.
  /// Settings of the lens that stand above those of the rig file, for one who measures what they
  /// should be; only for drivers that have_lens_traits().
  std::map<std::string, std::string> lens_overrides = {};
};

/// Something plugged in that a rig text could name.
struct FoundHardware {
  std::string text;         ///< What open_hardware takes: "v4l2:/dev/video0".
  std::string description;  ///< One line: model, what it can do.
  bool has_camera = false;
  bool has_lens = false;
  std::string problem;  ///< Why it cannot be opened now ("no permission; ..."), or empty.
};

/// What opens cameras and lenses of one kind, and finds them.
class RigDriver {
 public:
  virtual ~RigDriver() = default;
  /// The name before the colon of a rig text: lower case, e.g. "sim", "replay".
  virtual const char* name() const noexcept = 0;
  /// One line for --help: what it is and its most useful keys.
  virtual const char* summary() const noexcept = 0;
  /// The key that a bare value after the colon stands for (replay:PATH is replay:path=PATH), or
  /// null.
  virtual const char* bare_key() const noexcept { return nullptr; }
  /// The keys that may follow a bare value that may hold commas itself: replay:PATH,time=2. A value
  /// with a comma before one of them needs its own key. Where none are listed, a bare value ends at
  /// its first comma, and every key may follow: indi:HOST:PORT,gain=2.
  virtual std::span<const std::string_view> trailing_keys() const noexcept { return {}; }
  /// The keys whose values are paths; in a rig file they are relative to the file.
  virtual std::span<const std::string_view> path_keys() const noexcept { return {}; }
  /// Whether its lens takes the keys of LensTraits (hal/lens_traits.hpp): those of real rigs do.
  virtual bool has_lens_traits() const noexcept { return false; }
  /// What is plugged in. Changes nothing, moves nothing, and takes a second at most.
  virtual std::vector<FoundHardware> find() const { return {}; }
  /// Why find() could not look, and what to do, in one line ("no INDI server at localhost:7624; start
  /// one"); empty where it could. Takes no longer than find().
  virtual std::string obstacle() const { return {}; }
  /// Opens what is wanted and there; null for what the hardware has not. Throws Error(unavailable)
  /// (absent, or in use by somebody else), Error(io), Error(bad_argument), Error(bad_data),
  /// Error(unsupported) for settings that it cannot keep, Error(timeout).
  virtual Hardware open(const RigSettings& settings, const OpenOptions& options) const = 0;
};

/// Every rig driver of this build, generated by CMake from the add_rig_driver() lines of hal/.
std::span<const RigDriver* const> all_rig_drivers();

/// A driver that this build was made without.
struct AbsentRigDriver {
  const char* name;
  const char* reason;
};
/// Generated like the table above, from add_absent_rig_driver() lines.
std::span<const AbsentRigDriver> absent_rig_drivers();

/// Opens what a rig text names:
///   "sim", "sim:key=value,..."      one driver with its options
///   "replay:PATH"                   the same, with the driver's bare key
///   "FILE.toml"                     a rig file: driver = "sim" and its keys at the top level, or
///                                   tables [camera] and [lens], each with its own driver
/// All that is wanted is there afterwards. Throws as RigDriver::open, and Error(bad_argument)
/// with the choices for an unknown driver, Error(unavailable) where camera or lens is missing.
Hardware open_hardware(std::string_view text, const OpenOptions& options = {});

/// The driver that moves the lens of such a text, without opening anything. Throws as reading it
/// does.
const RigDriver& lens_driver_of(std::string_view text);

/// Whether such a text says something of its lens under this key, such as "backlash". Throws
/// likewise.
bool lens_has_key(std::string_view text, std::string_view key);

}  // namespace fathom
