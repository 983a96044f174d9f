#include "launcher/supervise/merge_scans.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "common/base/output_file.h"

namespace troupe {
namespace {

// The number after `start`, for instance after {"tick":
std::optional<std::uint64_t> NumberAfter(std::string_view start, const std::string& line) {
  if (!line.starts_with(start)) return std::nullopt;
  std::uint64_t number = 0;
  auto [end, failure] = std::from_chars(line.data() + start.size(), line.data() + line.size(), number);
  return failure == std::errc() ? std::optional(number) : std::nullopt;
}

// The time of a line: the edition of the world, and the tick.
using When = std::pair<std::uint64_t, std::uint64_t>;

// One part and a position in it.
class Part {
 public:
  explicit Part(LineFile file) : file_(std::move(file)) { Next(); }

  bool done() const { return done_; }
  // Once it is done.
  const Status& status() const { return file_.status(); }
  const When& when() const { return when_; }
  const std::string& line() const { return line_; }

  void Next() {
    for (;;) {
      done_ = !file_.Next(line_);
      if (done_) return;
      const std::optional<std::uint64_t> edition = NumberAfter("{\"edition\":", line_);
      if (!edition) break;
      when_ = {*edition, 0};
    }
    const std::optional<std::uint64_t> tick = NumberAfter("{\"tick\":", line_);
    done_ = !tick;
    if (tick) when_.second = *tick;
  }

 private:
  LineFile file_;
  std::string line_;
  When when_ = {0, 0};
  bool done_ = false;
};

// Writes the lines of `part` of one tick. A restarted agent may write a tick that its predecessor has written, in whole
// or in part: the repeated lines are omitted.
Status WriteTick(Part& part, const When& when, OutputFile& file) {
  const std::string first = part.line();
  std::size_t written = 0;
  std::size_t position = 0;
  for (; !part.done() && part.when() == when; part.Next(), ++position) {
    if (part.line() == first) position = 0;
    if (position < written) continue;
    file.Append(part.line());
    if (Status failure = file.EndLine(); !failure.ok()) return failure;
    ++written;
  }
  return Status();
}

}  // namespace

Status MergeScans(const std::vector<std::string>& parts, const std::string& output, LineFile::Space space) {
  std::vector<std::unique_ptr<Part>> open;
  for (const std::string& path : parts) {
    if (!std::filesystem::exists(path)) continue;
    Result<LineFile> part = LineFile::Open(path, space);
    if (!part.ok()) return part.error();
    open.push_back(std::make_unique<Part>(std::move(part).value()));
  }
  Result<OutputFile> file = OutputFile::Create(output);
  if (!file.ok()) return file.error();
  Status failure;
  std::uint64_t edition = 0;
  for (;;) {
    std::erase_if(open, [&failure](const auto& part) {
      if (part->done() && failure.ok()) failure = part->status();
      return part->done();
    });
    if (open.empty() || !failure.ok()) break;
    const When when = (*std::min_element(open.begin(), open.end(), [](const auto& a, const auto& b) {
                        return a->when() < b->when();
                      }))->when();
    if (when.first != edition) {
      edition = when.first;
      file.value().Append("{\"edition\":" + std::to_string(edition) + "}");
      failure = file.value().EndLine();
    }
    for (const auto& part : open) {
      if (failure.ok() && part->when() == when) failure = WriteTick(*part, when, file.value());
    }
  }
  const Status closed = file.value().Close();
  return failure.ok() ? closed : failure;
}

}  // namespace troupe
