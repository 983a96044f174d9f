// Diagnostics: the faults of a world file. The first error counts and ends the build; warnings are kept once for
// each place and text, so that a hundred robots made from one macro do not repeat them.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "common/base/result.h"

namespace troupe {

class Diagnostics {
 public:
  void Fail(const SourceLocation& where, const std::string& message) {
    if (!error_) error_ = Error{where, message};
  }
  void Warn(const SourceLocation& where, const std::string& message) {
    if (seen_.emplace(where.file, where.line, message).second) warnings_.push_back({where, message});
  }

  bool failed() const { return error_.has_value(); }
  const std::optional<Error>& error() const { return error_; }
  std::vector<Warning>& warnings() { return warnings_; }

 private:
  std::optional<Error> error_;
  std::vector<Warning> warnings_;
  std::set<std::tuple<std::string, int, std::string>> seen_;
};

}  // namespace troupe
