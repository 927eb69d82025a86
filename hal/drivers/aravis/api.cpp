// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/api.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <string>

#include "engine/error.hpp"

namespace fathom::aravis {
namespace {

constexpr const char* kLibrary = "libaravis-0.8.so.0";

struct Loaded {
  Api api;
  std::string problem;  ///< Empty where all functions were found.
};

/// dlsym gives a pointer to data; nobody forbids a system to have it point to code.
template <class Function>
void find(void* library, const char* name, Function& function, std::string& problem) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) problem = fmt::format("{} has no {}", kLibrary, name);
}

Loaded load() {
  Loaded loaded;
  void* const library = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const why = dlerror();
    loaded.problem = why == nullptr ? kLibrary : why;
    return loaded;
  }
#define FATHOM_ARAVIS_FIND(name) find(library, #name, loaded.api.name, loaded.problem);
  FATHOM_ARAVIS_FUNCTIONS(FATHOM_ARAVIS_FIND)
#undef FATHOM_ARAVIS_FIND
  return loaded;
}

}  // namespace

const Api& api() {
  static const Loaded loaded = load();
  if (loaded.problem.empty()) return loaded.api;
  throw Error(ErrorCode::unavailable,
              fmt::format("Aravis cannot be loaded: {}; install libaravis-0.8-0", loaded.problem));
}

}  // namespace fathom::aravis
