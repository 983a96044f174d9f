#include "launcher/commands/static_page.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/base64.h"
#include "common/base/file.h"
#include "common/base/paths.h"
#include "recording/recording_writer.h"
#include "testing/reports/svg_plot.h"
#include "viewer/gateway/web_server.h"

namespace troupe {
namespace {

constexpr std::size_t kMostModuleBytes = std::size_t{64} << 20;
constexpr int kGzip = 16;  // added to the bits of a window: the format of zlib's streams

// Nothing is loaded but what is in the file: the browser refuses all requests.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; worker-src blob:; "
    "style-src 'unsafe-inline'; img-src data: blob:; media-src blob:";

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

struct Module {
  std::string wasm;
  std::string worker;  // JavaScript
};

Result<Module> ReadModule(std::string folder) {
  if (folder.empty()) folder = InstalledFolder("module");
  const auto read = [&](const char* name) {
    return ReadWholeFile((std::filesystem::path(folder) / name).string(), kMostModuleBytes);
  };
  Result<std::string> wasm = read("troupe-core.wasm");
  const Result<std::string> loader = read("troupe-core.js");
  const Result<std::string> worker = read("page_worker.js");
  if (!wasm.ok() || !loader.ok() || !worker.ok()) {
    return Error{{folder},
                 "found no WebAssembly module, expected that of the preset wasm (scripts/setup emscripten node-acorn "
                 "libstb-dev; cmake --preset wasm; cmake --build --preset wasm), or its folder by --module"};
  }
  return Module{std::move(wasm).value(), loader.value() + "\n" + worker.value()};
}

std::string Element(const char* id, std::string_view bytes, const std::string& name = {}) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\" data-name=\"{}\">{}</script>\n", id, Escaped(name),
                     Base64(Gzip(bytes)));
}

// False: the page does not have the text once.
bool Replace(std::string& page, std::string_view text, const std::string& replacement) {
  const std::size_t at = page.find(text);
  if (at == std::string::npos) return false;
  page.replace(at, text.size(), replacement);
  return true;
}

}  // namespace

Status WriteStaticPage(const Recording& recording, const StaticPageOptions& options) {
  const Result<Module> module = ReadModule(options.module);
  if (!module.ok()) return module.error();
  // Without compression of its own, because the browser unpacks the whole.
  const Result<std::vector<std::byte>> plain = PlainCopy(recording);
  if (!plain.ok()) return plain.error();
  const std::string_view content(reinterpret_cast<const char*>(plain.value().data()), plain.value().size());

  std::string page;
  std::string styles;
  std::string script;
  for (const PageFile& file : PageFiles()) {
    if (file.path == "/") page = Unpacked(file);
    if (file.path == "/viewer.css") styles = Unpacked(file);
    if (file.path == "/viewer.js") script = Unpacked(file);
  }
  const std::string name = std::filesystem::path(recording.name()).filename().string();
  const std::string parts = Element("static-recording", content, name) + Element("static-module", module.value().wasm) +
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

}  // namespace troupe
