#include "worldfile/text/text_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "common/base/file.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

std::string NotReadable(const std::string& path, const std::string& reason) {
  return "cannot read " + QuotedPath(path) + " (" + reason + "), expected a readable file";
}

}  // namespace

std::string NotAllowed(const std::string& path, const AllowedPaths& allowed) {
  return fmt::format(
      "found {}, expected a file that the owner of the run has allowed (--allow-files), below one of: {}",
      QuotedPath(path), fmt::join(allowed.paths(), ", "));
}

Result<std::string> ReadTextFile(const std::string& named, const SourceLocation& where, const AllowedPaths& allowed) {
  const std::optional<std::string> resolved = allowed.Resolve(named);
  if (!resolved) return Error{where, NotAllowed(named, allowed)};
  const std::string& path = *resolved;
  const Result<FileDescriptor> file = OpenToRead(path);
  if (!file.ok()) {
    const bool is_other_kind = file.error().code == ErrorCode::kBadInput;
    return Error{where, is_other_kind ? "found " + QuotedPath(path) + ", expected a regular file"
                                      : NotReadable(path, file.error().message)};
  }
  Result<std::string> text = ReadToEnd(file.value(), path, kMaxTextFileBytes);
  if (text.ok()) return text;
  const bool is_too_long = text.error().code == ErrorCode::kBadInput;
  if (!is_too_long) return Error{where, NotReadable(path, text.error().message)};
  std::error_code ignored;
  return Error{where, fmt::format("found {} bytes in {}, expected at most {}",
                                  std::filesystem::file_size(path, ignored), QuotedPath(path), kMaxTextFileBytes)};
}

std::string DirectoryOf(const std::string& path) {
  const std::string directory = std::filesystem::path(path).parent_path().string();
  return directory.empty() ? "." : directory;
}

std::string FindFile(const std::string& name, const std::string& top_directory, const std::string& naming_file) {
  namespace fs = std::filesystem;
  const fs::path path(name);
  if (path.is_absolute()) return name;
  std::vector<fs::path> candidates = {fs::path(top_directory) / path, fs::path(DirectoryOf(naming_file)) / path};
  if (const char* folders = std::getenv("STAGEPATH")) {
    std::istringstream stream(folders);
    for (std::string folder; std::getline(stream, folder, ':');) {
      if (folder.empty()) continue;
      candidates.push_back(fs::path(folder) / path);
      candidates.push_back(fs::path(folder) / path.filename());
    }
  }
  for (fs::path& candidate : candidates) {
    candidate = candidate.lexically_normal();
    std::error_code ignored;
    if (fs::exists(candidate, ignored)) return candidate.string();
  }
  return candidates.front().string();
}

}  // namespace troupe
