#include "common/base/installed_folder.h"

#include <filesystem>
#include <system_error>

namespace troupe {

std::string InstalledWorldsFolder() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (failure) return {};
  const std::filesystem::path worlds = program.parent_path().parent_path() / "share/troupe/worlds";
  return std::filesystem::is_directory(worlds, failure) ? worlds.string() : std::string();
}

}  // namespace troupe
