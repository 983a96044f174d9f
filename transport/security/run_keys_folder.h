// RunKeysFolder: the folder for the keys of one run, which this process makes and deletes.
#pragma once

#include <string>

#include "troupe/result.h"

namespace troupe {

class RunKeysFolder {
 public:
  // In SessionsFolder(), of mode 0700. Deletes those that killed processes have left.
  static Result<RunKeysFolder> Make();

  // The same with a token in it.
  static Result<RunKeysFolder> MakeWithToken();

  RunKeysFolder() = default;  // none
  RunKeysFolder(RunKeysFolder&& other) noexcept;
  RunKeysFolder& operator=(RunKeysFolder&& other) noexcept;
  ~RunKeysFolder();

  const std::string& path() const { return path_; }  // empty: none

 private:
  std::string path_;
};

}  // namespace troupe
