#include "common/base/installed_folder.h"

#include <filesystem>
#include <system_error>

namespace troupe {

Result<std::string> ProgramFolder() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (failure) return Failure("cannot read /proc/self/exe: " + failure.message());
  return program.parent_path().string();
}

std::string InstalledWorldsFolder() {
  const Result<std::string> programs = ProgramFolder();
  if (!programs.ok()) return {};
  const std::filesystem::path worlds = std::filesystem::path(programs.value()).parent_path() / "share/troupe/worlds";
  std::error_code failure;
  return std::filesystem::is_directory(worlds, failure) ? worlds.string() : std::string();
}

}  // namespace troupe
