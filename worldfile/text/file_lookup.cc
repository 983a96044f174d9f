#include "worldfile/text/file_lookup.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

namespace troupe {

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
