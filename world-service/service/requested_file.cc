#include "world-service/service/requested_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>
#include <utility>

#include "common/base/file.h"
#include "common/base/paths.h"
#include "common/base/system_error.h"

namespace troupe {
namespace {

// The place and the message in one text, without the severity. A file that was not found has no line.
Error FlattenPlace(const Error& error) {
  constexpr std::string_view kSeverity = "error: ";
  std::string text = error.ToString();
  text.erase(text.find(kSeverity), kSeverity.size());
  const bool is_malformed = error.code == ErrorCode::kBadInput && error.where.line > 0;
  // A reply of the protocol has one text and a code: the code tells gateways (ROS) whether the file or the request is
  // wrong.
  return {{}, std::move(text), is_malformed ? ErrorCode::kMalformed : error.code};
}

Result<RequestedFile> ListModels(const ServiceOptions& options) {
  const Result<std::vector<Spawnable>> models = ListSpawnables(options.world_file, options.overrides);
  if (!models.ok()) return FlattenPlace(models.error());
  RequestedFile file;
  for (const Spawnable& model : models.value()) {
    const EntityKind kind = model.type == "position" ? EntityKind::kRobot : EntityKind::kModel;
    file.listed.push_back({.name = model.name, .type = model.type, .kind = kind});
  }
  return file;
}

// Worlds and scenarios in the folder of the request, or else in those that requests may read.
Result<RequestedFile> ListWorlds(const ServiceOptions& options, const control::Worlds& request) {
  const AllowedPaths& allowed = options.overrides.allowed;
  std::vector<std::string> folders = {request.folder};
  if (request.folder.empty()) folders = allowed.paths();
  // A set, because allowed folders may overlap and directories are read in any order: the list is sorted, each file
  // once.
  std::set<std::string> paths;
  for (const std::string& folder : folders) {
    const std::optional<std::string> path = allowed.Resolve(folder);
    std::error_code problem;
    if (path && std::filesystem::is_directory(*path, problem)) {
      for (const auto& entry : std::filesystem::directory_iterator(*path, problem)) {
        const std::string ending = entry.path().extension().string();
        if (ending == ".world" || ending == ".json" || ending == ".sdf") paths.insert(entry.path().string());
      }
    } else if (!request.folder.empty()) {
      return Error{{}, "found '" + folder + "', expected a folder that requests may read"};
    }
  }
  RequestedFile file;
  for (const std::string& path : paths) {
    file.listed.push_back({.name = std::filesystem::path(path).stem().string(), .type = path});
  }
  return file;
}

// Sets the ROS identity of the robot in `spawned`.
Status SetRosIdentity(const control::Spawn& request, WorldDescription& spawned) {
  if (request.ros_domain && spawned.robots.empty()) {
    return Error{{}, "found a ROS domain for a model that is no robot, expected one for robots only"};
  }
  for (RobotDescription& robot : spawned.robots) {
    robot.ros.name_space = request.ros_namespace;
    if (request.ros_domain) robot.ros.domain = request.ros_domain;
  }
  return {};
}

// The file that a request names, or its text as a file, which is then allowed.
struct Source {
  std::string path;
  std::shared_ptr<const RequestedText> text = {};
  LoadOverrides overrides;
};

Result<Source> SourceOf(const ServiceOptions& options, const std::string& path, const std::string& text) {
  Source source{path, {}, options.overrides};
  // The options are those of the run's own file.
  if (!text.empty() || path != options.world_file) {
    source.overrides.grid = {};
    source.overrides.robots.clear();
  }
  if (text.empty()) return source;
  Result<std::shared_ptr<const RequestedText>> written = RequestedText::Write(text);
  if (!written.ok()) return written.error();
  source.text = std::move(written).value();
  source.path = source.text->path();
  // The text of the request is permitted itself; what it includes is checked as for any other file.
  source.overrides.allowed.Add(source.path);
  return source;
}

Result<RequestedFile> ReadWorld(const ServiceOptions& options, const control::LoadWorld& request) {
  // A load without a file and without a text unloads the world: the empty world replaces it.
  if (request.source.empty() && request.text.empty()) {
    return RequestedFile{.world = {std::make_shared<const WorldDescription>()}};
  }
  Result<Source> source = SourceOf(options, request.source, request.text);
  if (!source.ok()) return source.error();
  Result<LoadedWorld> loaded = LoadWorld(source.value().path, source.value().overrides);
  if (!loaded.ok()) return FlattenPlace(loaded.error());
  if (Status status = CheckLibraries(loaded.value().world, options.libraries); !status.ok()) return status.error();
  return RequestedFile{.world = {std::make_shared<const WorldDescription>(std::move(loaded.value().world))},
                       .text = std::move(source.value().text)};
}

Result<RequestedFile> ReadSpawned(const ServiceOptions& options, const control::Spawn& request) {
  Result<Source> source = SourceOf(options, request.source, request.text);
  if (!source.ok()) return source.error();
  Result<LoadedWorld> loaded = LoadSpawnable({options.world_file}, source.value().path, source.value().overrides);
  if (!loaded.ok()) return FlattenPlace(loaded.error());
  WorldDescription& spawned = loaded.value().world;
  if (!request.controller.empty()) {
    const ControllerDescription controller = {request.controller, "{}"};
    if (Status status = SetController(controller, options.overrides, spawned); !status.ok()) return status.error();
  }
  // After SetController, so that a library named by the request is checked like one named by the file.
  if (Status status = CheckLibraries(spawned, options.libraries); !status.ok()) return status.error();
  if (Status status = SetRosIdentity(request, spawned); !status.ok()) return status.error();
  const std::optional<std::uint32_t> domains_from = loaded.value().ros_domains_from;
  return RequestedFile{.world = {std::make_shared<const WorldDescription>(std::move(spawned)), domains_from},
                       .text = std::move(source.value().text)};
}

Result<RequestedFile> Read(const ServiceOptions& options, const control::Request& request) {
  if (control::Is<control::Spawnables>(request)) return ListModels(options);
  if (const auto* const list = std::get_if<control::Worlds>(&request)) return ListWorlds(options, *list);
  if (const auto* const load = std::get_if<control::LoadWorld>(&request)) return ReadWorld(options, *load);
  if (const auto* const spawn = std::get_if<control::Spawn>(&request)) return ReadSpawned(options, *spawn);
  return Error{{}, "found a request without a file"};
}

}  // namespace

Result<RequestedFile> ReadRequestedFile(const ServiceOptions& options, const control::Request& request) {
  try {
    return Read(options, request);
  } catch (const std::exception& exception) {  // as of a file system that fails, or without memory
    return FailureOf(exception);
  }
}

Result<std::shared_ptr<const RequestedText>> RequestedText::Write(const std::string& text) {
  std::error_code no_folder;
  std::string folder = (std::filesystem::temp_directory_path(no_folder) / "troupe-text-XXXXXX").string();
  std::shared_ptr<RequestedText> file(new RequestedText());  // before the folder, which it removes
  if (no_folder) return Error{{}, "cannot make a folder for the text: " + no_folder.message()};
  if (mkdtemp(folder.data()) == nullptr) return SystemError("cannot make a folder for the text");
  file->folder_ = std::move(folder);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_scenario = first != std::string::npos && text[first] == '{';
  file->path_ = file->folder_ + (is_scenario ? "/text.json" : "/text.world");
  std::ofstream out(file->path_, std::ios::binary);
  out << text;
  out.close();
  if (!out) return Failure("cannot write the text to " + file->path_);
  return std::shared_ptr<const RequestedText>(std::move(file));
}

RequestedText::~RequestedText() {
  if (!folder_.empty()) RemoveAll(folder_);
}

void RestrictRequests(const OwnerPermissions& permissions, const WorldDescription& world,
                      const std::vector<std::string>& files, ServiceOptions& options) {
  AllowedPaths allowed;
  if (!options.world_file.empty()) {  // as in a damaged recording
    allowed.Add(std::filesystem::absolute(options.world_file).parent_path().string());
  }
  for (const std::string& file : files) allowed.Add(file);
  if (const std::string worlds = InstalledWorldsFolder(); !worlds.empty()) allowed.Add(worlds);
  for (const std::string& path : permissions.files) allowed.Add(path);
  options.overrides.allowed = allowed;

  AllowedPaths libraries;
  for (const std::string& library : LibrariesOf(world)) libraries.Add(library);
  if (options.overrides.controller && NamesLibrary(*options.overrides.controller)) {
    libraries.Add(ControllerFile(*options.overrides.controller));
  }
  for (const std::string& path : permissions.controllers) libraries.Add(path);
  options.libraries = libraries;
}

std::vector<std::string> LibrariesOf(const WorldDescription& world) {
  std::vector<std::string> libraries;
  for (const RobotDescription& robot : world.robots) {
    const std::string file = ControllerFile(robot.controller.name);
    if (NamesLibrary(file) && std::find(libraries.begin(), libraries.end(), file) == libraries.end()) {
      libraries.push_back(file);
    }
  }
  return libraries;
}

std::vector<std::string> InputFilesOf(const std::string& file, const LoadOverrides& overrides) {
  std::vector<std::string> files = {file};
  if (overrides.controller && NamesLibrary(*overrides.controller)) {
    files.push_back(ControllerFile(*overrides.controller));
  }
  const Result<LoadedWorld> loaded = LoadWorld(file, overrides);
  if (!loaded.ok()) return files;
  const std::vector<std::string> named = InputFilesOf(loaded.value());
  files.insert(files.end(), named.begin(), named.end());
  return files;
}

std::vector<std::string> InputFilesOf(const LoadedWorld& loaded) {
  std::vector<std::string> files = loaded.files;
  const std::vector<std::string> libraries = LibrariesOf(loaded.world);
  files.insert(files.end(), libraries.begin(), libraries.end());
  return files;
}

Status CheckLibraries(const WorldDescription& world, const AllowedPaths& libraries) {
  for (const RobotDescription& robot : world.robots) {
    const std::string& name = robot.controller.name;
    if (!NamesLibrary(name) || libraries.Resolve(ControllerFile(name))) continue;
    return Error{{},
                 fmt::format("robot {}: controller library {} is not allowed, expected a library that the owner of the "
                             "run has allowed (--allow-controllers)",
                             robot.name, name)};
  }
  return Status();
}

}  // namespace troupe
