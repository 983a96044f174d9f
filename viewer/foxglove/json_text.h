// JSON as Foxglove writes it. Private to this folder.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "viewer/foxglove/messages.h"

namespace troupe::foxglove {

using Json = nlohmann::json;

// {"sec": 1, "nsec": 500000000}
inline Json TimeOf(Time time) {
  constexpr Time kSecond = 1'000'000'000;
  return {{"sec", time / kSecond}, {"nsec", time % kSecond}};
}

// Names need not be UTF-8.
inline std::string Dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace troupe::foxglove
