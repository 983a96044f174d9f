#include "worldfile/text/text_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "common/base/file.h"

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
  // One open, then only the descriptor: between a check of the name and a later open the file could be replaced.
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
  // The size is for the message only, so that its failure does not matter.
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
  // Read at each call: tests and embedding programs set it at run time.
  if (const char* folders = std::getenv("STAGEPATH")) {
    std::istringstream stream(folders);
    for (std::string folder; std::getline(stream, folder, ':');) {
      if (folder.empty()) continue;
      candidates.push_back(fs::path(folder) / path);
      candidates.push_back(fs::path(folder) / path.filename());
    }
  }
  if (const std::string worlds = InstalledWorldsFolder(); !worlds.empty()) {
    candidates.push_back(fs::path(worlds) / "include" / path);
  }
  for (fs::path& candidate : candidates) {
    candidate = candidate.lexically_normal();
    std::error_code ignored;
    if (fs::exists(candidate, ignored)) return candidate.string();
  }
  return candidates.front().string();
}

std::optional<LeadingNumber> ReadLeadingNumber(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return std::nullopt;
  text.remove_prefix(begin);
  // from_chars takes no plus sign. "+-1" stays no number.
  if (text.front() == '+' && text.substr(1, 1) != "-") text.remove_prefix(1);
  LeadingNumber number;
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, number.value);
  if (read.ec != std::errc() || !std::isfinite(number.value)) return std::nullopt;
  number.is_all = std::string_view(read.ptr, static_cast<std::size_t>(end - read.ptr)).find_first_not_of(kBlanks) ==
                  std::string_view::npos;
  return number;
}

}  // namespace troupe
