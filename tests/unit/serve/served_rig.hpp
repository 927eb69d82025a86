// SPDX-License-Identifier: Apache-2.0
// A rig that is served on this computer, at a free port, for as long as this lives.
#pragma once

#include <memory>
#include <string>

namespace fathom::test {

class ServedRig {
 public:
  /// rig: what open_hardware takes.
  explicit ServedRig(const std::string& rig, bool is_read_only = false);
  ServedRig(const ServedRig&) = delete;
  ServedRig& operator=(const ServedRig&) = delete;
  ~ServedRig();

  /// A rig text that names it.
  std::string text() const;
  /// The same without a token.
  std::string bare_text() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fathom::test
