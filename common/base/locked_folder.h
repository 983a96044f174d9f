// LockedFolder: a temporary folder that others can tell from one whose maker has ended, by whatever cause.
//
// Its maker holds a lock of the kernel on it, which ends with the process. The number of a process would not do: a
// killed one keeps its number until its parent asks for its end, which in a container without an init is never, and a
// number is given to another process in the end. Only the folders of the own user count.
#pragma once

#include <filesystem>
#include <string>

namespace troupe {

class LockedFolder {
 public:
  LockedFolder() = default;  // none
  // Makes a folder of mode 0700; the last six characters of the path, XXXXXX, are replaced. None, with the reason in
  // errno, if it cannot.
  static LockedFolder Make(const std::string& pattern);

  LockedFolder(LockedFolder&& other) noexcept;
  LockedFolder& operator=(LockedFolder&& other) noexcept;
  ~LockedFolder();  // deletes it

  // Empty: none.
  const std::string& path() const { return path_; }

  // Another process holds the folder.
  static bool IsHeld(const std::filesystem::path& path);
  // Deletes a folder that no process holds.
  static void DeleteIfAbandoned(const std::filesystem::path& path);

 private:
  std::string path_;
  int lock_ = -1;
};

}  // namespace troupe
