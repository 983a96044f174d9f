// Diagnostics: the faults of a world file. The first error counts and ends the build; warnings are kept once for
// each place and text, so that a hundred robots made from one macro do not repeat them. Statements for Stage's window,
// of which worlds are full, share one warning.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "troupe/result.h"

namespace troupe {

class Diagnostics {
 public:
  void Fail(const SourceLocation& where, const std::string& message) {
    if (!error_) error_ = Error{where, message};
  }
  void Warn(const SourceLocation& where, const std::string& message) {
    if (seen_.emplace(where.file, where.line, message).second) warnings_.push_back({where, message});
  }

  // `statement`: "property 'gui_grid'". The warning is at the place of the first one.
  void WarnOfWindow(const SourceLocation& where, const std::string& statement) {
    if (std::find(for_window_.begin(), for_window_.end(), statement) != for_window_.end()) return;
    if (for_window_.empty()) {
      window_warning_ = warnings_.size();
      warnings_.push_back({where, ""});
    }
    for_window_.push_back(statement);
    std::string list;
    for (const std::string& each : for_window_) list += (list.empty() ? "" : ", ") + each;
    const bool one = for_window_.size() == 1;
    warnings_[window_warning_].message = one ? list + " has no effect: it only concerns Stage's window"
                                             : "no effect, because they only concern Stage's window: " + list;
  }

  bool failed() const { return error_.has_value(); }
  const std::optional<Error>& error() const { return error_; }
  std::vector<Warning>& warnings() { return warnings_; }

 private:
  std::optional<Error> error_;
  std::vector<Warning> warnings_;
  std::vector<std::string> for_window_;  // statements, in the order of the file
  std::size_t window_warning_ = 0;       // its index in warnings_
  std::set<std::tuple<std::string, int, std::string>> seen_;
};

}  // namespace troupe
