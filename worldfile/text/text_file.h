// The texts of users' files: reading them, places in them, their parts in messages, and warnings.
//
// Nothing in here knows a format. Errors have the place in the file (line and column from 1, column in bytes), so that
// editors can jump there; texts of users are escaped in messages, because a terminal would obey control characters in
// them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "common/base/paths.h"
#include "common/base/source_text.h"
#include "common/base/text.h"
#include "troupe/result.h"

namespace troupe {

// The files of users: reading one as a whole, and the paths of the files that it names.

// World files and scenarios are written by hand: anything larger is a mistake, and refused before it fills the memory.
inline constexpr std::size_t kMaxTextFileBytes = 64'000'000;

// The content of a regular file that `allowed` allows. Errors are placed at `where`, which is the file itself or the
// place that names it.
Result<std::string> ReadTextFile(const std::string& path, const SourceLocation& where,
                                 const AllowedPaths& allowed = AllowedPaths::All());

// The message for a path that is not allowed. It does not tell whether the file exists: a stranger's scenario must not
// explore the disk.
std::string NotAllowed(const std::string& path, const AllowedPaths& allowed);

// The folder part of a path, "." if it has none.
std::string DirectoryOf(const std::string& path);

// The path of the file that `naming_file` calls `name`: `name` itself if it is absolute; else the first that exists of
// `top_directory`/name (Stage's rule), the naming file's folder, and the folders of the environment variable STAGEPATH
// (separated by colons; with the whole name, then with its last part), and the installed models (`include` of the
// installed worlds). If none exists, the first of these.
std::string FindFile(const std::string& name, const std::string& top_directory, const std::string& naming_file);

// Diagnostics: the faults of a world file. The first error counts and ends the build; warnings are kept once for
// each place and text, so that a hundred robots made from one macro do not repeat them. Statements for Stage's window,
// of which worlds are full, share one warning.
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

// Numbers at the beginning of texts, as Stage and map_server read them, in any locale.

struct LeadingNumber {
  double value = 0.0;
  bool is_all = false;  // nothing but blanks follows
};

// The number at the beginning of the text, after blanks and perhaps a plus sign: 1.2 of "1.2.3", 5 of "5 m". Nothing
// for a text without one, or with one that is not finite. Decimal points only, whatever the locale of the process:
// strtod under a German locale would read 1 of "1.5".
std::optional<LeadingNumber> ReadLeadingNumber(std::string_view text);

}  // namespace troupe
