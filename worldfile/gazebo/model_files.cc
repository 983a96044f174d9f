#include "worldfile/gazebo/model_files.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>

#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxModelFiles = 5'000;
constexpr std::size_t kMaxModelBytes = 8 * kMaxTextFileBytes;
constexpr int kFoldersAbove = 4;

void AppendFolders(const char* variable, const char* below, std::vector<fs::path>& folders) {
  const char* const value = std::getenv(variable);
  if (value == nullptr) return;
  std::istringstream stream(value);
  for (std::string folder; std::getline(stream, folder, ':');) {
    if (!folder.empty()) folders.push_back(fs::path(folder) / below);
  }
}

// Read at each call: tests and embedding programs set them at run time.
std::vector<fs::path> SearchFolders(const std::string& naming_file) {
  std::vector<fs::path> folders;
  for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH",
                               "GAZEBO_RESOURCE_PATH", "ROS_PACKAGE_PATH"}) {
    AppendFolders(variable, "", folders);
  }
  AppendFolders("AMENT_PREFIX_PATH", "share", folders);
  std::error_code ignored;
  fs::path folder = fs::absolute(DirectoryOf(naming_file), ignored).lexically_normal();
  for (int i = 0; i <= kFoldersAbove; ++i) {
    folders.push_back(folder);
    folders.push_back(folder / "models");
    const fs::path above = folder.parent_path();
    if (above == folder) break;
    folder = above;
  }
  return folders;
}

// What follows "scheme://"; nothing for another URI.
std::optional<std::string> After(const std::string& uri, const std::string& scheme) {
  return uri.starts_with(scheme) ? std::optional(uri.substr(scheme.size())) : std::nullopt;
}

}  // namespace

bool ModelFiles::Exists(const std::string& path) const {
  std::error_code ignored;
  // Only what is allowed: the message of an error must not tell a stranger which files exist.
  return allowed_.Resolve(path) && fs::exists(path, ignored);
}

Result<std::string> ModelFiles::Find(const std::string& uri, const std::string& naming_file,
                                     const SourceLocation& where) const {
  if (uri.empty()) return Error{where, "found an empty URI, expected that of a file"};
  if (uri.starts_with("http://") || uri.starts_with("https://")) return FindDownloaded(uri, naming_file, where);
  std::optional<std::string> name = After(uri, "model://");
  if (!name) name = After(uri, "package://");
  std::string path = uri;
  if (!name) {
    if (const std::optional<std::string> file = After(uri, "file://")) path = *file;
    const fs::path beside = fs::path(path).is_absolute() ? fs::path(path) : fs::path(DirectoryOf(naming_file)) / path;
    if (Exists(beside.string()) || fs::path(path).is_absolute()) return beside.lexically_normal().string();
    name = path;
  }
  std::string sought;
  for (const fs::path& folder : SearchFolders(naming_file)) {
    const std::string candidate = (folder / *name).lexically_normal().string();
    if (Exists(candidate)) return candidate;
    sought += (sought.empty() ? "" : ":") + folder.string();
  }
  return Error{where, "found no file for " + QuotedPath(uri) + " in " + Quoted(sought, 300) +
                          ", expected one there: --model-path DIR or GZ_SIM_RESOURCE_PATH name further folders"};
}

// ".../1.0/OWNER/models/NAME": where Gazebo keeps what it has downloaded, else a folder NAME of the search.
Result<std::string> ModelFiles::FindDownloaded(const std::string& uri, const std::string& naming_file,
                                               const SourceLocation& where) const {
  std::vector<std::string> parts;
  std::istringstream stream(uri);
  for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
  // https:, "", server, version, owner, "models", name, perhaps more
  if (parts.size() >= 7 && parts[5] == "models") {
    const auto lower = [](std::string text) {
      for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      return text;
    };
    const char* const home = std::getenv("HOME");
    for (const char* const folder : {".gz/fuel", ".ignition/fuel"}) {
      const fs::path kept =
          fs::path(home != nullptr ? home : "/") / folder / parts[2] / lower(parts[4]) / "models" / lower(parts[6]);
      int newest = -1;
      for (int version = 0; version < 100; ++version) {
        if (Exists((kept / std::to_string(version)).string())) newest = version;
      }
      if (newest >= 0) return (kept / std::to_string(newest)).string();
    }
    for (const fs::path& folder : SearchFolders(naming_file)) {
      const std::string candidate = (folder / parts[6]).lexically_normal().string();
      if (Exists(candidate)) return candidate;
    }
  }
  return Error{where,
               "found " + QuotedPath(uri) +
                   ", which is on a server, expected a model of this machine: one that Gazebo has downloaded, or "
                   "a folder of its name on --model-path"};
}

Result<std::string> ModelFiles::FindModel(const std::string& uri, const std::string& naming_file,
                                          const SourceLocation& where) {
  Result<std::string> found = Find(uri, naming_file, where);
  std::error_code ignored;
  if (!found.ok() || !fs::is_directory(found.value(), ignored)) return found;
  const fs::path folder = found.value();
  std::string best;
  double best_version = -1.0;
  const std::string config = (folder / "model.config").string();
  if (Exists(config)) {
    const Result<std::shared_ptr<const XmlElement>> root = ReadXml(config, where);
    if (!root.ok()) return root.error();
    for (const XmlElement& child : root.value()->children) {
      if (child.name != "sdf") continue;
      const std::string* const text = child.FindAttribute("version");
      const std::optional<LeadingNumber> number = text != nullptr ? ReadLeadingNumber(*text) : std::nullopt;
      const double version = number ? number->value : 0.0;
      if (version <= best_version) continue;
      best_version = version;
      best = std::string(child.Trimmed());
    }
  }
  const std::string file = (folder / (best.empty() ? "model.sdf" : best)).lexically_normal().string();
  if (Exists(file)) return file;
  return Error{where, "found no " + Quoted(best.empty() ? "model.sdf" : best) + " in " + QuotedPath(folder.string()) +
                          ", expected the file of the model"};
}

Result<std::string> ModelFiles::ReadText(const std::string& path, const SourceLocation& where) {
  Result<std::string> text = ReadTextFile(path, where, allowed_);
  if (!text.ok()) return text;
  bytes_ += text.value().size();
  if (files_.size() >= kMaxModelFiles || bytes_ > kMaxModelBytes) {
    return Error{where, "found too many files, expected at most " + std::to_string(kMaxModelFiles) + " with " +
                            std::to_string(kMaxModelBytes) + " bytes together"};
  }
  files_.push_back(path);
  return text;
}

Result<std::shared_ptr<const XmlElement>> ModelFiles::ReadXml(const std::string& path, const SourceLocation& where) {
  if (const auto found = xml_.find(path); found != xml_.end()) return found->second;
  const Result<std::string> text = ReadText(path, where);
  if (!text.ok()) return text.error();
  Result<XmlElement> root = ParseXml(text.value(), path);
  if (!root.ok()) return root.error();
  auto kept = std::make_shared<const XmlElement>(std::move(root).value());
  xml_.emplace(path, kept);
  return kept;
}

void ModelFiles::ReplaceXml(const std::string& path, XmlElement root) {
  xml_[path] = std::make_shared<const XmlElement>(std::move(root));
}

Result<std::shared_ptr<const TriangleMesh>> ModelFiles::ReadMesh(const std::string& path, const SourceLocation& where) {
  if (const auto found = meshes_.find(path); found != meshes_.end()) return found->second;
  const Result<std::string> content = ReadText(path, where);
  if (!content.ok()) return content.error();
  Result<TriangleMesh> mesh = troupe::ReadMesh(content.value(), path);
  if (!mesh.ok()) return mesh.error();
  auto kept = std::make_shared<const TriangleMesh>(std::move(mesh).value());
  meshes_.emplace(path, kept);
  return kept;
}

}  // namespace troupe
