// SPDX-License-Identifier: Apache-2.0
// What an INDI server has said of its devices: their properties, as they stand now.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/drivers/indi/xml_stream.hpp"

namespace fathom::indi {

enum class Kind { number, toggle, text, light, blob };
enum class State { idle, ok, busy, alert };

/// One value of a property; which fields mean something depends on the property's kind.
struct Value {
  std::string name;
  double number = 0;  ///< NaN where the server sent none.
  double lowest = 0;  ///< INDI leaves lowest == highest where there are no limits,
  double highest = 0;
  double step = 0;  ///< and 0 where there is no step.
  bool is_on = false;
  std::string text;
};

struct Property {
  std::string device;
  std::string name;
  Kind kind = Kind::number;
  State state = State::idle;
  bool is_writable = true;
  std::vector<Value> values;
  std::uint64_t serial = 0;       ///< Which statement of the server this is: grows with every one.
  std::uint64_t busy_serial = 0;  ///< The last one that called it busy.

  /// Null where it has no such value.
  const Value* find(std::string_view value) const;
};

/// A picture as it came.
struct Blob {
  std::vector<std::byte> bytes;
  std::string format;       ///< ".fits"
  std::uint64_t size = 0;   ///< How many bytes the server says that there are.
  bool is_damaged = false;  ///< No base64.
};

class Devices {
 public:
  /// Takes in one element. Elements of no meaning are skipped, as the protocol wants it. Throws
  /// Error(bad_data) if the server defines more than any server has.
  void take(Element element);

  /// Null where it is not defined (any more).
  const Property* find(const std::string& device, const std::string& name) const;

  /// Those that have at least one property.
  std::vector<std::string> names() const;

  const std::map<std::pair<std::string, std::string>, Property>& all() const { return all_; }

  /// The last message about a device, or empty: what the driver says of a failure.
  std::string message(const std::string& device) const;
  void forget_message(const std::string& device) { messages_.erase(device); }

  /// How many properties were defined so far.
  std::uint64_t definitions() const { return definitions_; }

  /// The last picture of the camera's main chip, once.
  std::optional<Blob> take_picture() { return std::exchange(picture_, std::nullopt); }
  bool has_picture() const { return picture_.has_value(); }

 private:
  void define(const Element& element, Kind kind);
  void change(Element& element);
  void remove(const Element& element);

  std::map<std::pair<std::string, std::string>, Property> all_;
  std::map<std::string, std::string> messages_;
  std::optional<Blob> picture_;
  std::uint64_t definitions_ = 0;
  std::uint64_t statements_ = 0;
  std::size_t values_ = 0;
};

}  // namespace fathom::indi
