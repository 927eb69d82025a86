// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/completion_values.hpp"

#include <sstream>

#include "backends/backends.hpp"
#include "calibration/model.hpp"
#include "engine/metric.hpp"
#include "focus/searches.hpp"
#include "hal/rig_driver.hpp"
#include "tools/fathom/topics.hpp"

namespace fathom::cli {
namespace {

using Words = std::vector<std::string>;

Words rig_words() {
  Words words;
  for (const RigDriver* driver : all_rig_drivers()) {
    const bool stands_alone = driver->bare_key() == nullptr;
    words.push_back(std::string(driver->name()) + (stands_alone ? "" : ":"));
  }
  return words;
}

Words metric_words() {
  Words words;
  for (const Transform transform :
       {Transform::fft, Transform::walsh_sequency, Transform::walsh_paley,
        Transform::walsh_hadamard, Transform::dct}) {
    words.push_back(to_string(transform));
    words.push_back(MetricSpec::standard(transform, 64).text());
  }
  words.push_back("dct:entropy");
  return words;
}

Words search_words() {
  Words words;
  for (const Search& search : searches()) words.push_back(search.name);
  return words;
}

Words backend_words() {
  Words words{"auto"};
  for (const Backend* backend : all_backends()) words.push_back(backend->name());
  return words;
}

Words model_words() {
  Words words{"auto"};
  for (const CalibrationModel model : calibration_models()) words.push_back(to_string(model));
  return words;
}

Words topic_words() {
  Words words;
  for (const Topic& topic : topics()) words.push_back(topic.name);
  return words;
}

/// What the options of one name take, whichever verb they are of.
struct Known {
  const char* name;
  OfferedValues (*values)();
};

constexpr Known kKnown[] = {
    {"--rig",
     [] {
       return OfferedValues{rig_words(), true};
     }},
    {"RIG",
     [] {
       return OfferedValues{rig_words(), true};
     }},
    {"--metric",
     [] {
       return OfferedValues{metric_words(), false};
     }},
    {"--metrics",
     [] {
       return OfferedValues{metric_words(), false};
     }},
    {"--search",
     [] {
       return OfferedValues{search_words(), false};
     }},
    {"--searches",
     [] {
       return OfferedValues{search_words(), false};
     }},
    {"--backend",
     [] {
       return OfferedValues{backend_words(), false};
     }},
    {"--model",
     [] {
       return OfferedValues{model_words(), false};
     }},
    {"--peak",
     [] {
       return OfferedValues{{"fit", "evaluated"}, false};
     }},
    {"--window",
     [] {
       return OfferedValues{{"auto", "nearest"}, false};
     }},
    {"--align",
     [] {
       return OfferedValues{{"similarity", "scale", "none"}, false};
     }},
    {"--channel",
     [] {
       return OfferedValues{{"r", "g", "b"}, false};
     }},
    {"--page",
     [] {
       return OfferedValues{{"all"}, false};
     }},
    {"--completion",
     [] {
       return OfferedValues{{"bash", "zsh", "fish"}, false};
     }},
    {"--targets",
     [] {
       return OfferedValues{{"usaf", "seedling", "orange"}, false};
     }},
    {"RUN",
     [] {
       return OfferedValues{{"last"}, true};
     }},
    {"TOPIC",
     [] {
       return OfferedValues{topic_words(), false};
     }},
};

/// The numbers of "INT:{8,16}".
Words listed_numbers(const std::string& value) {
  const std::size_t open = value.find('{'), close = value.find('}');
  Words words;
  if (open == std::string::npos || close == std::string::npos) return words;
  std::istringstream list(value.substr(open + 1, close - open - 1));
  for (std::string number; std::getline(list, number, ',');) words.push_back(number);
  return words;
}

}  // namespace

std::vector<std::string> names_of(const OptionEntry& option) {
  std::istringstream list(option.names);
  std::vector<std::string> names;
  for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  return names;
}

OfferedValues offered_values(const OptionEntry& option) {
  for (const std::string& name : names_of(option)) {
    for (const Known& known : kKnown) {
      if (name == known.name) return known.values();
    }
  }
  const bool is_number = option.value.starts_with("INT") || option.value.starts_with("UINT") ||
                         option.value.starts_with("FLOAT");
  return {listed_numbers(option.value), !is_number};
}

}  // namespace fathom::cli
