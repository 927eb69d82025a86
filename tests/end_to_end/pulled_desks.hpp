// SPDX-License-Identifier: Apache-2.0
// Desks on which a cable can be pulled while the program measures.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

namespace fathom::test {

/// What is pulled out, or dies.
enum class Cable { stage, camera, alpaca, indi };
inline constexpr std::array kCables = {Cable::stage, Cable::camera, Cable::alpaca, Cable::indi};
const char* name_of(Cable cable);

/// A desk whose target is in focus at a known place. Nothing on it is noisy: the same place has the
/// same score each time.
class PulledDesk {
 public:
  virtual ~PulledDesk() = default;
  /// What the program takes as --rig.
  virtual std::string rig() const = 0;
  /// Where the focus is, and a step that is small beside its width, in the lens's unit.
  virtual double focus() const = 0;
  virtual double step() const = 0;
  /// How many pictures have been begun.
  int pictures() const { return pictures_; }
  /// What a message about the loss must name.
  virtual std::string name() const = 0;
  /// From any thread.
  virtual void pull() = 0;
  /// After the program has ended: says what is wrong with where the lens stands, and what the program
  /// would believe of it the next time; empty where that is right.
  virtual std::string wrong_belief() = 0;

 protected:
  std::atomic<int> pictures_ = 0;
};

/// folder: for its files.
std::unique_ptr<PulledDesk> make_desk(Cable cable, const std::filesystem::path& folder);

}  // namespace fathom::test
