// HostFolder: the temporary folder of `troupe host`, for keys and for files of its processes: troupe-host-PID-XXXXXX.
#pragma once

#include <string>

namespace troupe {

class HostFolder {
 public:
  // Makes it, and deletes those of this user's hosts that were killed.
  HostFolder();
  ~HostFolder();
  HostFolder(const HostFolder&) = delete;
  HostFolder& operator=(const HostFolder&) = delete;

  // Empty if it could not be made.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int lock_ = -1;  // on the folder: the kernel drops it at the end of the process, by whatever cause
};

}  // namespace troupe
