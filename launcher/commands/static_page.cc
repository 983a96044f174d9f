#include "launcher/commands/static_page.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/base64.h"
#include "common/base/file.h"
#include "common/base/json.h"
#include "common/base/paths.h"
#include "common/base/print.h"
#include "launcher/commands/temporary_folder.h"
#include "recording/recording_writer.h"
#include "robot-agent/controller/create_controller.h"
#include "viewer/gateway/web_server.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxModuleBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxContentBytes = std::size_t{256} << 20;  // of a file
// In the page, as on a machine where Troupe is installed.
constexpr const char* kOwnFolder = "/home";
constexpr const char* kProgram = "/usr/bin/troupe";
constexpr const char* kInstalledWorlds = "/usr/share/troupe/worlds";
constexpr int kGzip = 16;  // added to the bits of a window: the format of zlib's streams

// Nothing is loaded but what is in the file: the browser refuses all requests.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; worker-src blob:; "
    "style-src 'unsafe-inline'; img-src data: blob:; media-src blob:";

// The format that the browser's DecompressionStream reads.
std::string Gzip(std::string_view bytes) {
  z_stream stream = {};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    throw std::bad_alloc();
  }
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

// Of a file of the page, which the build has packed.
std::string Unpacked(const PageFile& file) {
  if (!file.compressed) return std::string(file.content);
  z_stream stream = {};
  if (inflateInit2(&stream, MAX_WBITS + kGzip) != Z_OK) throw std::bad_alloc();
  std::string bytes;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.content.data()));
  stream.avail_in = static_cast<uInt>(file.content.size());
  int outcome = Z_OK;
  while (outcome == Z_OK) {
    const std::size_t done = bytes.size();
    bytes.resize(std::max<std::size_t>(2 * done, std::size_t{64} << 10));
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    stream.avail_out = static_cast<uInt>(bytes.size() - done);
    outcome = inflate(&stream, Z_NO_FLUSH);
    bytes.resize(stream.total_out);
  }
  inflateEnd(&stream);
  return bytes;
}

// The simulation for the page, as scripts/build-module builds it.
struct Module {
  std::string wasm;
  std::string worker;  // JavaScript
};

Result<Module> ReadModule(std::string folder) {
  if (folder.empty()) folder = InstalledFolder("module");
  const auto read = [&](const char* name) {
    return ReadWholeFile((std::filesystem::path(folder) / name).string(), kMaxModuleBytes);
  };
  Result<std::string> wasm = read("troupe-core.wasm");
  const Result<std::string> loader = read("troupe-core.js");
  const Result<std::string> worker = read("page_worker.js");
  if (!wasm.ok() || !loader.ok() || !worker.ok()) {
    return Error{
        {folder},
        "found no WebAssembly module, expected that of `scripts/build-module`, which takes five to ten minutes of "
        "processor time once, or its folder by --module"};
  }
  return Module{std::move(wasm).value(), loader.value() + "\n" + worker.value()};
}

// A script element of type text/plain is not run and not shown. Base64, since HTML cannot carry any byte.
std::string Element(const char* id, std::string_view bytes) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, Base64(Gzip(bytes)));
}

// False: the page does not have the text once.
bool Replace(std::string& page, std::string_view text, const std::string& replacement) {
  const std::size_t at = page.find(text);
  if (at == std::string::npos) return false;
  page.replace(at, text.size(), replacement);
  return true;
}

// What a page shows, for viewer/module/page_worker.js.
class Content {
 public:
  // `file`: the one of those that are added which the page opens.
  Content(std::string file, const ShownExpectations& expectations)
      : file_(std::move(file)), expectations_(ToJson(expectations)) {}

  void Add(const std::string& path, std::string_view bytes) {
    files_.push_back({path, bytes.size()});
    bytes_.append(bytes);
  }

  std::string Bytes(const std::string& name) const {
    const nlohmann::json head = {
        {"name", name}, {"file", file_}, {"program", kProgram}, {"files", files_}, {"expectations", expectations_}};
    return JsonText(head) + "\n" + bytes_;
  }

 private:
  const std::string file_;
  const nlohmann::json expectations_;
  nlohmann::json files_ = nlohmann::json::array();
  std::string bytes_;
};

// Styles and scripts of the page move into the file. A page without the expected elements was built without node and
// npm.
Status WritePage(const Content& content, const std::string& name, const StaticPageOptions& options) {
  const Result<Module> module = ReadModule(options.module);
  if (!module.ok()) return module.error();
  std::string page;
  std::string styles;
  std::string script;
  for (const PageFile& file : PageFiles()) {
    if (file.path == "/") page = Unpacked(file);
    if (file.path == "/viewer.css") styles = Unpacked(file);
    if (file.path == "/viewer.js") script = Unpacked(file);
  }
  const std::string parts = Element("static-content", content.Bytes(name)) +
                            Element("static-module", module.value().wasm) +
                            Element("static-worker", module.value().worker);
  const bool is_whole =
      Replace(page, "<meta charset=\"utf-8\">",
              fmt::format("<meta charset=\"utf-8\">\n  <meta http-equiv=\"Content-Security-Policy\" content=\"{}\">",
                          kPolicy)) &&
      Replace(page, "<link rel=\"stylesheet\" href=\"/viewer.css\">", "<style>" + styles + "</style>") &&
      Replace(page, "<script type=\"module\" src=\"/viewer.js\"></script>",
              parts + "<script type=\"module\">" + script + "</script>");
  if (!is_whole) return Error{{}, "found no page, expected that of troupe view: build with node and npm"};
  return WriteWholeFile(options.output, page);
}

std::string Absolute(const std::string& path) {
  std::error_code failure;
  std::filesystem::path absolute = std::filesystem::canonical(path, failure);
  if (failure) absolute = std::filesystem::absolute(path, failure);
  return absolute.string();
}

bool IsBelow(const std::string& path, const std::string& folder) {
  return path.size() > folder.size() && path.starts_with(folder) && path[folder.size()] == '/';
}

// The innermost folder that has all of the files.
std::string CommonFolder(const std::vector<std::string>& files) {
  std::string folder = std::filesystem::path(files.front()).parent_path().string();
  for (const std::string& file : files) {
    while (!folder.empty() && !IsBelow(file, folder)) folder.erase(folder.find_last_of('/'));
  }
  return folder;
}

// Why the module cannot run the robots; ok: it can.
// A library or a class in Python is a program for this machine.
Status CheckControllers(const WorldDescription& world) {
  for (const RobotDescription& robot : world.robots) {
    const std::string& name = robot.controller.name;
    if (!NamesLibrary(name)) continue;
    return Error{
        {},
        fmt::format("robot {}: the controller {} is {}, which does not run in a page, expected built-in "
                    "controllers; a page with a recording shows any run (troupe run --record)",
                    robot.name, name, ControllerFile(name) == name ? "a shared library" : "a class in Python")};
  }
  return {};
}

// The module is built without the JPEG library.
Result<std::string> ReadForPage(const std::string& file) {
  Result<std::string> bytes = ReadWholeFile(file, kMaxContentBytes);
  if (!bytes.ok()) return Error{{file}, "cannot read: " + bytes.error().message};
  if (bytes.value().starts_with("\xff\xd8\xff")) {
    return Error{{file},
                 "found a JPEG image, which a page does not read, expected a PNG image; a page with a recording shows "
                 "any run (troupe run --record)"};
  }
  return bytes;
}

// A copy below a folder that is there.
Status WriteCopy(const std::string& file, const std::string& bytes) {
  std::error_code failure;
  std::filesystem::create_directories(std::filesystem::path(file).parent_path(), failure);
  return WriteWholeFile(file, bytes);
}

}  // namespace

bool HasPageModule(const StaticPageOptions& options) {
  const std::string folder = options.module.empty() ? InstalledFolder("module") : options.module;
  std::error_code failure;
  return std::filesystem::exists(std::filesystem::path(folder) / "troupe-core.wasm", failure);
}

Status WriteStaticPage(const Recording& recording, const ShownExpectations& expectations,
                       const StaticPageOptions& options) {
  // Without compression of its own, because the browser unpacks the whole.
  const Result<std::vector<std::byte>> plain = PlainCopy(recording);
  if (!plain.ok()) return plain.error();
  Content content("/run.mcap", expectations);
  content.Add("/run.mcap", {reinterpret_cast<const char*>(plain.value().data()), plain.value().size()});
  return WritePage(content, std::filesystem::path(recording.name()).filename().string(), options);
}

// The copy below is loaded as the page will load it, and must give the same world: a page that fails on another machine
// is found here.
Status WriteStaticPage(const std::string& world_file, const ShownExpectations& expectations,
                       const StaticPageOptions& options) {
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  const Result<LoadedWorld> loaded = LoadWorld(world_file, overrides);
  if (!loaded.ok()) return loaded.error();
  for (const Warning& warning : loaded.value().warnings) PrintPlain(stderr, "{}\n", warning.ToString());
  if (loaded.value().settings.ros) {
    PrintPlain(stderr, "{}: warning: the page has no ROS 2: the run is as by troupe run --no-ros\n", world_file);
  }
  if (Status problem = CheckControllers(loaded.value().world); !problem.ok()) return problem;

  // Their places in the page tell nothing of this machine: below the innermost folder of all, or of the installation.
  const std::string installed = Absolute(InstalledFolder("worlds"));
  const std::string own_file = Absolute(world_file);
  const auto is_own = [&](const std::string& file) {
    return IsBelow(own_file, installed) || !IsBelow(file, installed);
  };
  std::map<std::string, std::string> files;  // their bytes, by absolute path
  std::vector<std::string> own;
  std::vector<std::string> listed = {world_file};
  listed.insert(listed.end(), loaded.value().files.begin(), loaded.value().files.end());
  for (const std::string& each : listed) {
    const std::string file = Absolute(each);
    if (files.contains(file)) continue;
    Result<std::string> bytes = ReadForPage(each);
    if (!bytes.ok()) return bytes.error();
    files.emplace(file, std::move(bytes).value());
    if (is_own(file)) own.push_back(file);
  }
  const std::string folder = CommonFolder(own);
  const TemporaryFolder copy;
  if (copy.path().empty()) return Failure("cannot make a folder for temporary files");
  Content content(kOwnFolder + own_file.substr(folder.size()), expectations);
  for (const auto& [file, bytes] : files) {
    if (is_own(file)) {
      const std::string place = file.substr(folder.size());
      content.Add(kOwnFolder + place, bytes);
      if (Status written = WriteCopy(copy.path() + place, bytes); !written.ok()) return written;
    } else {
      content.Add(kInstalledWorlds + file.substr(installed.size()), bytes);
    }
  }
  // The names in the files lead to the same files there.
  overrides.allowed = AllowedPaths();
  overrides.allowed.Add(copy.path());
  overrides.allowed.Add(installed);
  const Result<LoadedWorld> again = LoadWorld(copy.path() + own_file.substr(folder.size()), overrides);
  if (!again.ok() || again.value().world != loaded.value().world) {
    return Error{
        {world_file},
        "found files by absolute paths or in STAGEPATH, expected paths that begin at the files that name them, so "
        "that a page can have them"};
  }
  return WritePage(content, std::filesystem::path(world_file).filename().string(), options);
}

}  // namespace troupe
