// Parameters: reads a controller's JSON parameters strictly. Every key must be known and every value of the right kind;
// the first thing that is not becomes the error.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/model/world_description.h"

namespace troupe {

class Parameters {
 public:
  struct NamedNumber {
    const char* name;
    double value;
  };

  // `place` starts every message, for instance "wander" or "script: command 3".
  Parameters(std::string place, const std::string& json);
  Parameters(std::string place, const nlohmann::json& object);
  ~Parameters();

  // Each sets `value` if the key is there, and returns whether it is.
  bool ReadNumber(const char* key, const Interval& allowed, double& value);
  bool ReadBool(const char* key, bool& value);
  // A number, or one of the `names` for a number. `allowed` may be empty (upside down): names only.
  bool ReadNumberOrName(const char* key, const Interval& allowed, const std::vector<NamedNumber>& names, double& value);
  // The elements of an array; nothing if it is missing or wrong.
  std::vector<nlohmann::json> ReadArray(const char* key);
  // The members of an object, by name; nothing if it is missing or wrong.
  std::vector<std::pair<std::string, nlohmann::json>> ReadObject(const char* key);

  void Fail(const std::string& message);

  const std::string& error() const { return error_; }
  // Call it when all keys have been read: "" or the first error, which may be a key that nobody asked for.
  std::string Finish();

 private:
  const nlohmann::json* Find(const char* key);

  std::string place_;
  std::unique_ptr<nlohmann::json> object_;
  std::vector<std::string> known_;
  std::string error_;
};

}  // namespace troupe
