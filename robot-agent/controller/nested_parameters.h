// NestedParameters: parameters with lists and objects in them, for built-in controllers.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/parameters.h"

namespace troupe {

class NestedParameters : public Parameters {
 public:
  using Parameters::Parameters;
  // The error is a value that is not an object.
  NestedParameters(std::string place, const nlohmann::json& object);

  // The elements of a list; empty if it is missing or wrong.
  std::vector<nlohmann::json> ReadArray(const char* key);
  // The members of an object, by name; empty if it is missing or wrong.
  std::vector<std::pair<std::string, nlohmann::json>> ReadObject(const char* key);
  // A value of any kind; nothing if it is missing.
  std::optional<nlohmann::json> ReadAny(const char* key);
};

}  // namespace troupe
