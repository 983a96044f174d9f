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

  // Of the hosts of this user with folders beside this one, those that serve the same name end, with all processes that
  // they started: a launcher has lost its connection to them.
  void TakeOver(const std::string& name);

  // Empty if it could not be made.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int lock_ = -1;  // on the folder: the kernel drops it at the end of the process, by whatever cause
};

}  // namespace troupe
