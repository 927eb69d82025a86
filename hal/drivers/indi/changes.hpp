// SPDX-License-Identifier: Apache-2.0
// Properties of a device as they are found, so that they can be put back.
#pragma once

#include <string>
#include <vector>

#include "hal/drivers/indi/client.hpp"

namespace fathom::indi {

/// Changes properties of one device and, when destroyed, puts back what it found, last change
/// first, within three seconds; what is refused then is asked for once more. A device that is gone,
/// or that refuses twice, keeps what it has.
class Changes {
 public:
  Changes(Client& client, std::string device) : client_(client), device_(std::move(device)) {}
  ~Changes();
  Changes(const Changes&) = delete;
  Changes& operator=(const Changes&) = delete;

  /// Nothing is sent if the property stands as wished already. Throws as Client::set_numbers.
  void set_numbers(const std::string& name, const std::vector<NumberWish>& wishes);
  void set_switch(const std::string& name, const std::string& value);

 private:
  void remember(const Property& property);
  void put_back(const Property& found);
  std::vector<Property> put_back_all(std::vector<Property> wanted, std::int64_t deadline_ns);

  Client& client_;
  std::string device_;
  std::vector<Property> found_;
};

}  // namespace fathom::indi
