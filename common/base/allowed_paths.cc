#include "common/base/allowed_paths.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace troupe {
namespace {

namespace fs = std::filesystem;

// Nothing if a link cannot be followed.
std::optional<fs::path> WithoutLinks(const std::string& path) {
  std::error_code failure;
  const fs::path absolute = fs::absolute(path, failure);
  if (failure) return std::nullopt;
  fs::path resolved = fs::weakly_canonical(absolute, failure);
  if (failure) return std::nullopt;
  if (!resolved.has_filename()) resolved = resolved.parent_path();  // a folder written with a slash at its end
  return resolved;
}

bool IsBelow(const fs::path& path, const fs::path& folder) {
  const auto [end_of_folder, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end_of_folder == folder.end();
}

}  // namespace

AllowedPaths AllowedPaths::All() {
  AllowedPaths all;
  all.all_ = true;
  return all;
}

void AllowedPaths::Add(const std::string& path) {
  if (const std::optional<fs::path> resolved = WithoutLinks(path)) paths_.push_back(resolved->string());
}

std::optional<std::string> AllowedPaths::Resolve(const std::string& path) const {
  if (all_) return path;
  const std::optional<fs::path> resolved = WithoutLinks(path);
  if (!resolved) return std::nullopt;
  const bool allowed =
      std::any_of(paths_.begin(), paths_.end(), [&](const std::string& folder) { return IsBelow(*resolved, folder); });
  if (!allowed) return std::nullopt;
  return resolved->string();
}

}  // namespace troupe
