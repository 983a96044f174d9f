#include "viewer/editor/edited_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/worldfile/text/text_file.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

Error CannotWrite(const std::string& path, const char* what) {
  return {{path},
          fmt::format("cannot {}: {}; the file is as it was", what, std::strerror(errno)),
          ErrorCode::kOutputFailed};
}

bool WriteAll(int descriptor, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(descriptor, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    written += static_cast<std::size_t>(count);
  }
  return true;
}

// Nothing: there is no file.
Result<std::optional<std::string>> ReadIfThere(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return std::optional<std::string>();
  Result<std::string> text = ReadTextFile(path, {path});
  if (!text.ok()) return text.error();
  return std::optional(std::move(text).value());
}

}  // namespace

Result<EditedFile> EditedFile::Open(const std::string& path, const std::string& initial) {
  Result<std::optional<std::string>> on_disk = ReadIfThere(path);
  if (!on_disk.ok()) return on_disk.error();
  if (on_disk.value()) {
    std::string text = *on_disk.value();
    return EditedFile(path, std::move(text), std::move(on_disk).value());
  }
  const std::string folder = fs::path(path).parent_path().string();
  std::error_code error;
  if (!fs::is_directory(folder.empty() ? "." : folder, error)) {
    return Error{{path}, "found no folder for the new file, expected one that exists"};
  }
  return EditedFile(path, initial, std::nullopt);
}

void EditedFile::Change(std::string text, std::string label) {
  if (text == states_[at_].text) return;
  states_.resize(at_ + 1);
  states_.push_back({std::move(text), std::move(label)});
  std::size_t bytes = 0;
  for (const State& state : states_) bytes += state.text.size();
  while (states_.size() > 2 && (states_.size() > kMostStates || bytes > kMostHistoryBytes)) {
    bytes -= states_.front().text.size();
    states_.erase(states_.begin());
  }
  at_ = states_.size() - 1;
}

std::optional<std::string> EditedFile::undo_label() const {
  return at_ > 0 ? std::optional(states_[at_].label) : std::nullopt;
}

std::optional<std::string> EditedFile::redo_label() const {
  return at_ + 1 < states_.size() ? std::optional(states_[at_ + 1].label) : std::nullopt;
}

Status EditedFile::Save(bool overwrite) {
  if (!overwrite) {
    const Result<std::optional<std::string>> now = ReadIfThere(path_);
    if (!now.ok()) return now.error();
    if (now.value() != on_disk_) {
      const char* const what = !now.value() ? "was deleted"
                               : on_disk_   ? "was changed by another program"
                                            : "was created";
      return Error{{path_}, fmt::format("the file {} since it was read; it is not saved", what), ErrorCode::kNoRoom};
    }
  }
  if (Status failure = ReplaceFile(path_, text()); !failure.ok()) return failure;
  on_disk_ = text();
  return {};
}

Status EditedFile::Reload() {
  Result<std::string> text = ReadTextFile(path_, {path_});
  if (!text.ok()) return text.error();
  on_disk_ = text.value();
  Change(std::move(text).value(), "the reading of the file");
  return {};
}

Status ReplaceFile(const std::string& named, const std::string& text) {
  std::error_code error;
  // A link stays one.
  const fs::path path = fs::exists(named, error) ? fs::canonical(named, error) : fs::path(named);
  if (error) return Error{{named}, "cannot find the file: " + error.message(), ErrorCode::kOutputFailed};
  mode_t mode = 0644;
  if (struct stat status{}; stat(path.c_str(), &status) == 0) {
    if (access(path.c_str(), W_OK) != 0) return CannotWrite(named, "write the file");
    mode = status.st_mode & 07777;
  }
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  std::string temporary = (folder / ("." + path.filename().string() + ".XXXXXX")).string();
  const int descriptor = mkostemp(temporary.data(), O_CLOEXEC);
  if (descriptor < 0) return CannotWrite(named, "create a file beside it");
  bool done = WriteAll(descriptor, text) && fchmod(descriptor, mode) == 0 && fsync(descriptor) == 0;
  int reason = errno;
  done = close(descriptor) == 0 && done;
  if (done && rename(temporary.c_str(), path.c_str()) != 0) {
    reason = errno;
    done = false;
  }
  if (!done) {
    unlink(temporary.c_str());
    errno = reason;
    return CannotWrite(named, "save");
  }
  if (const int directory = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); directory >= 0) {
    fsync(directory);  // the name, too; a file system that cannot do it keeps the content
    close(directory);
  }
  return {};
}

}  // namespace troupe
