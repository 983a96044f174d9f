// Parameters: reads a controller's JSON parameters strictly. Every key must be known and every value of the right kind;
// the first violation becomes the error.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/model/interval.h"

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

  // Nothing if the key is missing or its value is wrong, which is an error.
  std::optional<double> ReadNumber(const char* key, const Interval& allowed);
  std::optional<bool> ReadBool(const char* key);
  // A number, or one of the `names` for a number. `allowed` may be empty (min > max): names only.
  std::optional<double> ReadNumberOrName(const char* key, const Interval& allowed,
                                         const std::vector<NamedNumber>& names);
  // The elements of an array; empty if it is missing or wrong.
  std::vector<nlohmann::json> ReadArray(const char* key);
  // The members of an object, by name; empty if it is missing or wrong.
  std::vector<std::pair<std::string, nlohmann::json>> ReadObject(const char* key);

  // Records an error, if it is the first one.
  void Fail(const std::string& message);

  // The first error so far.
  Status status() const { return error_ ? Status(Error{{}, *error_}) : Status(); }
  // The first error, also for keys that were never read. Call it after all reads.
  Status Finish();

 private:
  // Null if the key is missing.
  const nlohmann::json* Find(const char* key);

  std::string place_;
  std::unique_ptr<nlohmann::json> object_;
  std::vector<std::string> known_;
  std::optional<std::string> error_;
};

}  // namespace troupe
