#include "viewer/editor/model_library.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <utility>

#include "common/base/paths.h"
#include "viewer/editor/editable_world.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/gazebo/gazebo_tree.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

std::string WithoutLinks(const std::string& path) {
  std::error_code ignored;
  return fs::weakly_canonical(path, ignored).string();
}

bool HasOwnBody(const WorldNode& node) {
  const auto is_given = [&](const char* name) { return node.Find(name) != nullptr; };
  const bool has_blocks = std::any_of(node.children.begin(), node.children.end(),
                                      [](const WorldNode& child) { return child.type == "block"; });
  return has_blocks || is_given("size") || is_given("bitmap");
}

// A file that cannot be read or parsed is a library without models: a broken file of the installation must not hide the
// others.
ModelLibrary ReadLibrary(const std::string& path) {
  ModelLibrary library{path, {}};
  NamedFiles files;
  for (const std::string& folder : LibraryFolders()) files.allowed.Add(folder);
  const Result<std::string> text = ReadTextFile(path, {path}, files.allowed);
  if (!text.ok()) return library;
  ParseOptions options;
  options.allowed = files.allowed;
  const Result<WorldTree> tree = ParseStageText(text.value(), path, options);
  if (!tree.ok()) return library;
  for (const PaletteModel& model : PaletteOf(tree.value())) {
    const Result<WorldNode> node = Instantiate(tree.value(), model.name, {});
    if (model.where.file.empty() || !node.ok() || !HasOwnBody(node.value())) continue;
    const Result<LoadedWorld> alone = BuildAlone(tree.value(), model.name, files);
    if (alone.ok()) library.models.push_back({model.name, model.type, model.where, PictureOf(alone.value().world)});
  }
  return library;
}

}  // namespace

// In the order in which includes are looked for.
std::vector<std::string> LibraryFolders() {
  std::vector<std::string> found;
  const char* const folders = std::getenv("STAGEPATH");
  std::istringstream list(folders != nullptr ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');) {
    if (!folder.empty()) found.push_back(folder);
  }
  if (const std::string worlds = InstalledWorldsFolder(); !worlds.empty()) {
    found.push_back((fs::path(worlds) / "include").string());
  }
  return found;
}

// Sorted by name within a folder: the order of a directory is any.
std::vector<ModelLibrary> ReadLibraries() {
  std::vector<ModelLibrary> libraries;
  std::set<std::string> seen;
  for (const std::string& folder : LibraryFolders()) {
    std::vector<std::string> paths;
    std::error_code failure;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
      if (entry.path().extension() == ".inc") paths.push_back(WithoutLinks(entry.path().string()));
    }
    std::sort(paths.begin(), paths.end());
    for (const std::string& path : paths) {
      if (!seen.insert(path).second) continue;
      ModelLibrary library = ReadLibrary(path);
      if (!library.models.empty()) libraries.push_back(std::move(library));
    }
  }
  return libraries;
}

ModelLibrary ReadModelFiles(const std::string& folder, const AllowedPaths& allowed) {
  constexpr std::size_t kMostFiles = 50;  // each may have meshes
  std::vector<fs::path> paths;
  std::error_code failure;
  for (auto at = fs::recursive_directory_iterator(folder, failure); at != fs::recursive_directory_iterator();
       at.increment(failure)) {
    if (failure) break;
    if (at.depth() > 0) at.disable_recursion_pending();
    if (IsModelFile(at->path().string()) && at->is_regular_file(failure)) paths.push_back(at->path());
  }
  std::sort(paths.begin(), paths.end());
  ModelLibrary library;
  for (const fs::path& path : paths) {
    if (library.models.size() >= kMostFiles) break;
    WorldTree tree;
    tree.directory = folder;
    const std::string name = fs::relative(path, folder, failure).string();
    if (!DefineModelFile(name, path.string(), {path.string()}, allowed, tree).ok()) continue;
    const Result<LoadedWorld> alone = BuildAlone(tree, name, {allowed});
    if (!alone.ok()) continue;
    library.models.push_back({name, tree.defines.at(name).base, {path.string()}, PictureOf(alone.value().world)});
  }
  return library;
}

std::string NameOfLibrary(const ModelLibrary& library, const std::string& path) {
  const std::string name = fs::path(library.path).filename().string();
  const bool is_found = WithoutLinks(FindFile(name, DirectoryOf(path), path)) == library.path;
  return is_found ? name : library.path;
}

std::string WithInclude(const std::string& text, const StageTree& tree, const std::string& name) {
  const std::string end_of_line = EndOfLineIn(text);
  const std::string written = "include \"" + name + "\"" + end_of_line;
  const Statement* last = nullptr;  // before the entries
  for (const Statement& statement : tree.statements) {
    if (statement.kind == StatementKind::kEntry && statement.name != "window") break;
    last = &statement;
  }
  if (last != nullptr && last->kind == StatementKind::kInclude) {
    const std::size_t end = LineEnd(text, last->span.end);
    return ApplyChanges(text, {{{end, end}, end_of_line + written.substr(0, written.size() - end_of_line.size())}});
  }
  return WithBeforeEntries(text, tree, written);
}

}  // namespace troupe
