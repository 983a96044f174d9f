#include "common/base/paths.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
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
  // By parts of the path, not by characters: "/data2" is not below "/data".
  const auto [end_of_folder, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end_of_folder == folder.end();
}

// Empty if the file can be read.
std::string Fault(const std::string& path) {
  // A named pipe would block without O_NONBLOCK.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return std::strerror(errno);
  struct stat status {};
  const bool known = fstat(file, &status) == 0;
  close(file);
  if (!known || !S_ISREG(status.st_mode)) return "not a file";
  return status.st_size == 0 ? "empty" : "";
}

// The folder of the shared library that this code is in, if a program of another project has loaded it.
std::optional<fs::path> LibraryFolder() {
#ifndef __EMSCRIPTEN__
  Dl_info code{};
  std::error_code failure;
  if (dladdr(reinterpret_cast<const void*>(&LibraryFolder), &code) == 0) return std::nullopt;
  const fs::path file = fs::canonical(code.dli_fname, failure);
  if (!failure && !fs::equivalent(file, "/proc/self/exe", failure) && !failure) return file.parent_path();
#endif
  return std::nullopt;
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

Result<std::string> ProgramFolder() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (failure) return Failure("cannot read /proc/self/exe: " + failure.message());
  return program.parent_path().string();
}

std::string InstalledFolder(const std::string& name) {
  const Result<std::string> programs = ProgramFolder();
  if (!programs.ok()) return {};
  const fs::path beside_program = fs::path(programs.value()).parent_path() / "share/troupe" / name;
  std::vector<fs::path> folders = {beside_program};
  if (const std::optional<fs::path> library = LibraryFolder()) {
    folders.push_back(library->parent_path() / "share/troupe" / name);                // lib
    folders.push_back(library->parent_path().parent_path() / "share/troupe" / name);  // lib/ARCHITECTURE
    folders.push_back(*library / name);  // a package for Python, with all that it needs
  }
  for (const fs::path& folder : folders) {
    std::error_code failure;
    if (fs::is_directory(folder, failure)) return folder.string();
  }
  return beside_program.string();
}

std::string InstalledWorldsFolder() {
  std::string worlds = InstalledFolder("worlds");
  std::error_code failure;
  return std::filesystem::is_directory(worlds, failure) ? worlds : std::string();
}

Status CheckEnclave(const std::string& folder) {
  std::error_code failure;
  if (!std::filesystem::is_directory(folder, failure)) {
    return Error{{folder}, "found no such folder, expected the keys of a participant"};
  }
  for (const char* name : kEnclaveFiles) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    if (const std::string fault = Fault(path); !fault.empty()) {
      return Error{{path}, "cannot read a file of the folder of keys: " + fault};
    }
  }
  return {};
}

}  // namespace troupe
