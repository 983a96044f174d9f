#include "viewer/editor/edited_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/base/file.h"
#include "common/base/hash.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

// To notice that another program has changed a file; not for security.
std::uint64_t HashOf(const std::string& bytes) {
  Hasher hasher;
  hasher.Add(bytes);
  return hasher.value();
}

// The hash of the file's bytes; nothing: no file exists, or it cannot be read.
std::optional<std::uint64_t> HashOfFile(const std::string& path) {
  const Result<std::string> bytes = ReadTextFile(path, {path});
  return bytes.ok() ? std::optional(HashOf(bytes.value())) : std::nullopt;
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

Status EditedPictures::Open(const std::string& path) {
  if (files_.contains(path)) return {};
  if (files_.size() >= kMaxPictures) return Error{{path}, "found too many images in editing, expected at most 32"};
  const std::optional<std::uint64_t> bytes = HashOfFile(path);
  const Result<GreyImage> image = ReadGreyPng(path);
  if (!image.ok()) return image.error();
  const auto picture = std::make_shared<const GreyPicture>(image.value());
  files_.emplace(path, OnDisk{picture, picture, bytes});
  return {};
}

Status EditedPictures::Create(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return Error{{path}, "found the file in use, expected a new name"};
  if (files_.size() >= kMaxPictures) return Error{{path}, "found too many images in editing, expected at most 32"};
  files_.emplace(path, OnDisk{});
  return {};
}

PicturePointer EditedPictures::Find(const PictureVersions& versions, const std::string& path) const {
  if (const auto version = versions.find(path); version != versions.end()) return version->second;
  const auto file = files_.find(path);
  return file != files_.end() ? file->second.opened : nullptr;
}

// Equal pointers first: comparing pixels is slow.
std::vector<std::string> EditedPictures::Modified(const PictureVersions& versions) const {
  std::vector<std::string> modified;
  for (const auto& [path, file] : files_) {
    const PicturePointer now = Find(versions, path);
    if (now == nullptr || now == file.saved) continue;
    if (file.saved == nullptr || !(*now == *file.saved)) modified.push_back(path);
  }
  return modified;
}

// A file that has appeared or disappeared counts as changed.
Status EditedPictures::CheckUnchanged(const std::string& path) const {
  const auto file = files_.find(path);
  const std::optional<std::uint64_t> now = HashOfFile(path);
  if (file == files_.end() || now == file->second.bytes) return {};
  const char* const what = !now ? "was deleted" : file->second.bytes ? "was changed by another program" : "was created";
  return Error{{path}, fmt::format("the image {} since it was read; it is not saved", what), ErrorCode::kNoRoom};
}

void EditedPictures::SetSaved(const std::string& path, PicturePointer content, const std::string& bytes) {
  OnDisk& file = files_[path];
  file.saved = std::move(content);
  file.bytes = HashOf(bytes);
}

void EditedPictures::Reload(PictureVersions& versions) {
  for (auto& [path, file] : files_) {
    const std::optional<std::uint64_t> bytes = HashOfFile(path);
    const Result<GreyImage> image = ReadGreyPng(path);
    if (!image.ok()) continue;
    file.saved = versions[path] = std::make_shared<const GreyPicture>(image.value());
    file.bytes = bytes;
  }
}

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

// Images that a state shares with the one before need no memory.
std::size_t EditedFile::BytesOf(const State& state, const State* before) const {
  std::size_t bytes = state.text.size();
  for (const auto& [path, picture] : state.versions) {
    const PicturePointer old = pictures_.Find(before != nullptr ? before->versions : PictureVersions(), path);
    if (picture != nullptr && picture != old) bytes += picture->BytesBeyond(old.get());
  }
  return bytes;
}

// Undone states are dropped. When the oldest is dropped, the next one owns the pixels that it shared.
void EditedFile::Change(std::string text, PictureVersions versions, std::string label) {
  if (text == Now().text && versions == Now().versions) return;
  if (joined_) {
    joined_->text = std::move(text);
    joined_->versions = std::move(versions);
    return;
  }
  states_.resize(at_ + 1);
  states_.push_back({std::move(text), std::move(versions), std::move(label), 0});
  states_.back().bytes = BytesOf(states_.back(), &states_[at_]);
  std::size_t bytes = 0;
  for (const State& state : states_) bytes += state.bytes;
  while (states_.size() > 2 && (states_.size() > kMaxStates || bytes > kMaxHistoryBytes)) {
    bytes -= states_[0].bytes + states_[1].bytes;
    states_.erase(states_.begin());
    states_[0].bytes = BytesOf(states_[0], nullptr);
    bytes += states_[0].bytes;
  }
  at_ = states_.size() - 1;
}

void EditedFile::EndJoined(std::string label) {
  State state = std::move(*joined_);
  joined_.reset();
  Change(std::move(state.text), std::move(state.versions), std::move(label));
}

bool EditedFile::is_modified(const std::set<std::string>& named) const {
  return !on_disk_ || *on_disk_ != text() || HasModifiedPictures(named);
}

bool EditedFile::has_unsaved_edits(const std::set<std::string>& named) const {
  return on_disk_.value_or(initial_) != text() || HasModifiedPictures(named);
}

bool EditedFile::HasModifiedPictures(const std::set<std::string>& named) const {
  const std::vector<std::string> modified = pictures_.Modified(versions());
  return std::any_of(modified.begin(), modified.end(), [&](const auto& path) { return named.contains(path); });
}

std::optional<std::string> EditedFile::undo_label() const {
  return at_ > 0 ? std::optional(states_[at_].label) : std::nullopt;
}

std::optional<std::string> EditedFile::redo_label() const {
  return at_ + 1 < states_.size() ? std::optional(states_[at_ + 1].label) : std::nullopt;
}

// First all checks, then all new files, then the replacements: a full disk leaves every file as it was.
Status EditedFile::Save(bool overwrite, const std::set<std::string>& named) {
  std::vector<std::string> changed = pictures_.Modified(versions());
  std::erase_if(changed, [&](const std::string& path) { return !named.contains(path); });
  if (!overwrite) {
    const Result<std::optional<std::string>> now = ReadIfThere(path_);
    if (!now.ok()) return now.error();
    if (now.value() != on_disk_) {
      const char* const what = !now.value() ? "was deleted"
                               : on_disk_   ? "was changed by another program"
                                            : "was created";
      return Error{{path_}, fmt::format("the file {} since it was read; it is not saved", what), ErrorCode::kNoRoom};
    }
    for (const std::string& path : changed) {
      if (Status conflict = pictures_.CheckUnchanged(path); !conflict.ok()) return conflict;
    }
  }
  std::vector<FileReplacement> replacements;
  std::vector<std::string> contents;
  for (const std::string& path : changed) {
    Result<std::string> bytes = EncodeGreyPng(Picture(path)->Image());
    if (!bytes.ok()) return bytes.error();
    Result<FileReplacement> replacement = FileReplacement::Prepare(path, bytes.value());
    if (!replacement.ok()) return replacement.error();
    replacements.push_back(std::move(replacement).value());
    contents.push_back(std::move(bytes).value());
  }
  Result<FileReplacement> of_text = FileReplacement::Prepare(path_, text());
  if (!of_text.ok()) return of_text.error();
  // The images first: the text of a new one names a file that exists.
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (Status failure = replacements[i].Commit(); !failure.ok()) return failure;
    pictures_.SetSaved(changed[i], Picture(changed[i]), contents[i]);
  }
  if (Status failure = of_text.value().Commit(); !failure.ok()) return failure;
  on_disk_ = text();
  return {};
}

Status EditedFile::Reload() {
  Result<std::string> text = ReadTextFile(path_, {path_});
  if (!text.ok()) return text.error();
  on_disk_ = text.value();
  PictureVersions read = versions();
  pictures_.Reload(read);
  Change(std::move(text).value(), std::move(read), "the reading of the file");
  return {};
}

}  // namespace troupe
