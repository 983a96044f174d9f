// The paths of the files that a world file names.
#pragma once

#include <string>

namespace troupe {

// The folder part of a path, "." if it has none.
std::string DirectoryOf(const std::string& path);

// The path of the file that `naming_file` calls `name`: `name` itself if it is absolute; else the first that exists of
// `top_directory`/name (Stage's rule), the naming file's folder, and the folders of the environment variable STAGEPATH
// (separated by colons; with the whole name, then with its last part). If none exists, the first of these.
std::string FindFile(const std::string& name, const std::string& top_directory, const std::string& naming_file);

}  // namespace troupe
