// AllowedPaths: the files that may be opened on behalf of another process.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace troupe {

class AllowedPaths {
 public:
  // Allows nothing.
  AllowedPaths() = default;
  // Allows every path.
  static AllowedPaths All();

  // Allows a file, or a folder with everything below it. Links are resolved now; a relative path starts at the working
  // directory.
  void Add(const std::string& path);

  // The path to open in place of `path`, with all links resolved; nothing if it is not allowed. A file that does not
  // exist may be allowed.
  std::optional<std::string> Resolve(const std::string& path) const;

  // Resolved, in the order of Add.
  const std::vector<std::string>& paths() const { return paths_; }

 private:
  bool all_ = false;
  std::vector<std::string> paths_;
};

}  // namespace troupe
