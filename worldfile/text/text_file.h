// The files of users: reading one as a whole, and the paths of those that it names.
#pragma once

#include <cstddef>
#include <string>

#include "common/base/allowed_paths.h"
#include "troupe/result.h"

namespace troupe {

// World files and scenarios are written by hand: anything larger is a mistake.
inline constexpr std::size_t kMaxTextFileBytes = 64'000'000;

// The content of a regular file that `allowed` allows. Errors are placed at `where`, which is the file itself or the
// place that names it.
Result<std::string> ReadTextFile(const std::string& path, const SourceLocation& where,
                                 const AllowedPaths& allowed = AllowedPaths::All());

// The message for a path that is not allowed. It does not tell whether the file exists.
std::string NotAllowed(const std::string& path, const AllowedPaths& allowed);

// The folder part of a path, "." if it has none.
std::string DirectoryOf(const std::string& path);

// The path of the file that `naming_file` calls `name`: `name` itself if it is absolute; else the first that exists of
// `top_directory`/name (Stage's rule), the naming file's folder, and the folders of the environment variable STAGEPATH
// (separated by colons; with the whole name, then with its last part). If none exists, the first of these.
std::string FindFile(const std::string& name, const std::string& top_directory, const std::string& naming_file);

}  // namespace troupe
