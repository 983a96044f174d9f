// The folders of the installation that the running program belongs to.
#pragma once

#include <string>

namespace troupe {

// "PREFIX/share/troupe/worlds" for a program in PREFIX/bin; empty if there is no such folder.
std::string InstalledWorldsFolder();

}  // namespace troupe
