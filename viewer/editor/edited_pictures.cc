#include "viewer/editor/edited_pictures.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "common/base/hash.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

std::uint64_t HashOf(const std::string& bytes) {
  Hasher hasher;
  hasher.Add(bytes);
  return hasher.value();
}

// Of the file's bytes; nothing: there is no file, or none that can be read.
std::optional<std::uint64_t> HashOfFile(const std::string& path) {
  const Result<std::string> bytes = ReadTextFile(path, {path});
  return bytes.ok() ? std::optional(HashOf(bytes.value())) : std::nullopt;
}

}  // namespace

Status EditedPictures::Open(const std::string& path) {
  if (files_.contains(path)) return {};
  if (files_.size() >= kMostPictures) return Error{{path}, "found too many images in editing, expected at most 32"};
  const std::optional<std::uint64_t> bytes = HashOfFile(path);
  const Result<GreyImage> image = ReadGreyPng(path);
  if (!image.ok()) return image.error();
  const auto picture = std::make_shared<const GreyPicture>(image.value());
  files_.emplace(path, OnDisk{picture, picture, bytes});
  return {};
}

Status EditedPictures::Create(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return Error{{path}, "found the file in use, expected a new name"};
  if (files_.size() >= kMostPictures) return Error{{path}, "found too many images in editing, expected at most 32"};
  files_.emplace(path, OnDisk{});
  return {};
}

PicturePointer EditedPictures::Find(const PictureVersions& versions, const std::string& path) const {
  if (const auto version = versions.find(path); version != versions.end()) return version->second;
  const auto file = files_.find(path);
  return file != files_.end() ? file->second.opened : nullptr;
}

std::vector<std::string> EditedPictures::Modified(const PictureVersions& versions) const {
  std::vector<std::string> modified;
  for (const auto& [path, file] : files_) {
    const PicturePointer now = Find(versions, path);
    if (now == nullptr || now == file.saved) continue;
    if (file.saved == nullptr || !(*now == *file.saved)) modified.push_back(path);
  }
  return modified;
}

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

}  // namespace troupe
