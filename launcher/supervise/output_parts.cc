#include "launcher/supervise/output_parts.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

namespace troupe {
namespace {

// For `count` parts that are open here, and once more while they are merged.
void AllowOpenFiles(std::size_t count) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, std::max<rlim_t>(limit.rlim_cur, 2 * count + 64));
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

OutputParts::OutputParts(const std::string& output, const std::string& option) : option_(option) {
  std::error_code ignored;
  folder_ = std::filesystem::is_regular_file(output, ignored)
                ? std::filesystem::absolute(output, ignored).parent_path().string()
                : std::filesystem::temp_directory_path(ignored).string();
}

OutputParts::~OutputParts() {
  for (int descriptor : descriptors_) close(descriptor);
}

Result<std::string> OutputParts::Add() {
  AllowOpenFiles(descriptors_.size() + 1);
  std::string name = folder_ + "/troupe-part-XXXXXX";
  int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) return Failure(option_ + ": cannot make a file in " + folder_ + ": " + strerror(errno));
  unlink(name.c_str());
  descriptors_.push_back(descriptor);
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(descriptor);
}

}  // namespace troupe
