// The files of a request: a world to load, a model to spawn, or the list of such models.
//
// Reading a file is slow and may block on a network file system, so it happens on the thread of RunService without the
// lock of the run; the coordinator gets the finished description. A request may come from any process that can reach
// the session: what it may read is limited by OwnerPermissions, checked by the loader for every included file as well,
// and symbolic links are resolved before the comparison (AllowedPaths).
//
// A controller that is a shared library is code: it is compared with a list of its own, which a permitted folder of
// worlds does not extend.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "world-service/service/run_control.h"
#include "world-service/service/run_service.h"
#include "worldfile/load_world.h"

namespace troupe {

// The text of a request as a file, which the readers of worlds expect. Deleted with the last copy.
class RequestedText {
 public:
  // A scenario begins with a brace; any other text is a Stage world.
  static Result<std::shared_ptr<const RequestedText>> Write(const std::string& text);
  ~RequestedText();
  RequestedText(const RequestedText&) = delete;
  RequestedText& operator=(const RequestedText&) = delete;

  const std::string& path() const { return path_; }

 private:
  RequestedText() = default;

  std::string folder_;
  std::string path_;
};

struct RequestedFile {
  RequestedWorld world = {};                       // of LoadWorld and Spawn
  std::vector<EntityReport> listed = {};           // of Spawnables and Worlds
  std::shared_ptr<const RequestedText> text = {};  // of LoadWorld with a text
};

// The error's message has the place in the file. Another request than LoadWorld, Spawn, Spawnables and Worlds
// needs no file: it is an error.
Result<RequestedFile> ReadRequestedFile(const ServiceOptions& options, const control::Request& request);

// OwnerPermissions: the files and controller libraries that the requests of other processes may name.

// The settings of a command line: files, or folders with everything below them.
struct OwnerPermissions {
  std::vector<std::string> files;        // worlds and models, with the files that these include
  std::vector<std::string> controllers;  // libraries
};

// Restricts the requests of a run: they may name the permitted files, those below the folder of the run's own file,
// those that it has read, and the installed worlds; as controllers the permitted libraries and its own robots'
// libraries. `world`, `files`: that of the run, and those that were read for it. REQUIRES: world_file and overrides of
// the options are set.
void RestrictRequests(const OwnerPermissions& permissions, const WorldDescription& world,
                      const std::vector<std::string>& files, ServiceOptions& options);

// The names of controllers of `world` that are libraries, each once, in the order of the robots.
std::vector<std::string> LibrariesOf(const WorldDescription& world);

// The files that are read for a run of `file`: itself, those that it names, and the libraries of its controllers. Of a
// recording, or of a file that does not load: itself.
std::vector<std::string> InputFilesOf(const std::string& file, const LoadOverrides& overrides);
std::vector<std::string> InputFilesOf(const LoadedWorld& loaded);  // without the file itself

// The error names the first robot of a requested world that has a library for a controller that is not allowed.
Status CheckLibraries(const WorldDescription& world, const AllowedPaths& libraries);

}  // namespace troupe
