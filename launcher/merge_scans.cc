#include "launcher/merge_scans.h"

#include <string.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "world-service/service/output_file.h"

namespace troupe {
namespace {

constexpr char kLineStart[] = "{\"tick\":";

std::optional<std::uint64_t> TickOf(const std::string& line) {
  if (!line.starts_with(kLineStart)) return std::nullopt;
  std::uint64_t tick = 0;
  auto [end, failure] = std::from_chars(line.data() + sizeof kLineStart - 1, line.data() + line.size(), tick);
  return failure == std::errc() ? std::optional(tick) : std::nullopt;
}

// One part, standing at a line.
class Part {
 public:
  explicit Part(const std::string& path) : file_(path) { Next(); }

  bool opened() const { return file_.is_open(); }
  bool done() const { return done_; }
  std::uint64_t tick() const { return tick_; }
  const std::string& line() const { return line_; }

  void Next() {
    // A line that ends with the file has no line end: it was cut off.
    done_ = !std::getline(file_, line_) || file_.eof();
    if (done_) return;
    std::optional<std::uint64_t> tick = TickOf(line_);
    done_ = !tick;
    if (tick) tick_ = *tick;
  }

 private:
  std::ifstream file_;
  std::string line_;
  std::uint64_t tick_ = 0;
  bool done_ = false;
};

// Writes the lines that `part` has of `tick`. A robot that is started again may measure a tick that its last process
// has written already, wholly or in part: what comes again is left out.
Status WriteTick(Part& part, std::uint64_t tick, OutputFile& file) {
  const std::string first = part.line();
  std::size_t written = 0;
  std::size_t position = 0;
  for (; !part.done() && part.tick() == tick; part.Next(), ++position) {
    if (part.line() == first) position = 0;
    if (position < written) continue;
    file.Append(part.line());
    if (Status failure = file.EndLine()) return failure;
    ++written;
  }
  return std::nullopt;
}

}  // namespace

Status MergeScans(const std::vector<std::string>& parts, const std::string& output) {
  std::vector<std::unique_ptr<Part>> open;
  for (const std::string& path : parts) {
    if (!std::filesystem::exists(path)) continue;
    open.push_back(std::make_unique<Part>(path));
    if (!open.back()->opened()) return Error{{}, "cannot read " + path + ": " + strerror(errno)};
  }
  Result<OutputFile> file = OutputFile::Create(output);
  if (!file.ok()) return file.error();
  Status failure;
  for (;;) {
    std::erase_if(open, [](const auto& part) { return part->done(); });
    if (open.empty() || failure) break;
    std::uint64_t tick = (*std::min_element(open.begin(), open.end(), [](const auto& a, const auto& b) {
                           return a->tick() < b->tick();
                         }))->tick();
    for (const auto& part : open) {
      if (!failure && part->tick() == tick) failure = WriteTick(*part, tick, file.value());
    }
  }
  return file.value().Close();
}

}  // namespace troupe
