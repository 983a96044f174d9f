// The memory that a process maps, as /proc tells it.
// With it tests prove that processes share frames instead of copying them, which no output of theirs would show.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace troupe::test {

struct MappedArea {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::string access;  // "r--s"
  std::string inode;
  std::string name;  // "/memfd:troupe-frames"; empty: memory without a file
};

// Empty if the process does not exist.
inline std::vector<MappedArea> MapsOf(pid_t process) {
  std::vector<MappedArea> areas;
  std::ifstream file("/proc/" + std::to_string(process) + "/maps");
  for (std::string line; std::getline(file, line);) {
    MappedArea area;
    char dash = 0;
    std::string offset;
    std::string device;
    std::istringstream(line) >> std::hex >> area.begin >> dash >> area.end >> area.access >> offset >> device >>
        area.inode >> area.name;
    areas.push_back(area);
  }
  return areas;
}

}  // namespace troupe::test
