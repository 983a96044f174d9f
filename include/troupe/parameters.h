// Parameters: reads the parameters of a controller strictly. Every key must be known and every value of the right kind;
// the first violation becomes the error. For a controller of one's own:
//
//   Parameters parameters("follow_wall", info.parameters);
//   speed_ = parameters.ReadNumber("speed", {0.1, 2.0}).value_or(0.3);  // m/s
//   if (const Status status = parameters.Finish(); !status.ok()) throw std::invalid_argument(status.error().message);
//
// Each Read returns nothing if the key is missing, or if its value is wrong, which is an error.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "troupe/interval.h"
#include "troupe/result.h"

namespace troupe {

class JsonReader;

class Parameters {
 public:
  struct NamedNumber {
    const char* name;
    double value;
  };

  // `json`: an object. `place` starts every message, for instance "wander".
  Parameters(std::string place, const std::string& json);
  ~Parameters();
  Parameters(const Parameters&) = delete;
  Parameters& operator=(const Parameters&) = delete;

  // A finite number, both ends of `allowed` included.
  std::optional<double> ReadNumber(const char* key, const Interval& allowed);
  std::optional<bool> ReadBool(const char* key);
  std::optional<std::string> ReadText(const char* key);
  // A number, or one of the `names` for a number. `allowed` may be empty (min > max): names only.
  std::optional<double> ReadNumberOrName(const char* key, const Interval& allowed,
                                         const std::vector<NamedNumber>& names);

  // Records an error, if it is the first one.
  void Fail(const std::string& message);

  // The first error so far.
  Status status() const;
  // The first error, also for keys that were never read. Call it after all reads.
  Status Finish();

  // For values of other kinds, of the controllers of this project.
  const JsonReader& reader() const { return *reader_; }

 private:
  std::unique_ptr<JsonReader> reader_;  // never null
};

}  // namespace troupe
