#include "worldfile/text/text_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

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
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    return Error{where, NotReadable(path, std::strerror(error ? error.value() : ENOENT))};
  }
  // Anything else (a folder, a pipe, a device) could fail late or never end.
  if (!std::filesystem::is_regular_file(status)) {
    return Error{where, "found " + QuotedPath(path) + ", expected a regular file"};
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Error{where, NotReadable(path, std::strerror(errno))};
  const auto size = std::filesystem::file_size(path, error);
  if (error) return Error{where, NotReadable(path, error.message())};
  if (size > kMaxTextFileBytes) {
    return Error{where, "found " + std::to_string(size) + " bytes in " + QuotedPath(path) + ", expected at most " +
                            std::to_string(kMaxTextFileBytes)};
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
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
