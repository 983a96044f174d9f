#include "launcher/supervise/output_files.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/output_file.h"
#include "common/base/system_error.h"
#include "world-service/service/requested_file.h"

namespace troupe {
namespace {

// For `count` parts that are open here, and once more while they are merged.
// A soft limit of 1024 files, as usual, is too few for a run of a thousand agents. A refusal shows when a part is made.
void AllowOpenFiles(std::size_t count) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, std::max<rlim_t>(limit.rlim_cur, 2 * count + 64));
  setrlimit(RLIMIT_NOFILE, &limit);
}

// The number after `start`, for instance after {"tick":
// Only the first number of a line is needed, so that long lines of scans are copied without being parsed.
std::optional<std::uint64_t> NumberAfter(std::string_view start, const std::string& line) {
  if (!line.starts_with(start)) return std::nullopt;
  std::uint64_t number = 0;
  auto [end, failure] = std::from_chars(line.data() + start.size(), line.data() + line.size(), number);
  return failure == std::errc() ? std::optional(number) : std::nullopt;
}

// The time of a line: the edition of the world, and the tick.
// Ticks alone are no order: an edit may set the run back to tick 0.
using When = std::pair<std::uint64_t, std::uint64_t>;

// One part and a position in it.
// A line {"edition":N} applies to the lines that follow it. A line without a tick ends the part: it is one that a
// killed agent has left half written.
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

// All files that a run may write; an output that is missing here is not checked.
std::vector<OutputName> OutputsOf(const RunOptions& options) {
  std::vector<OutputName> outputs = {{"--hash-log", options.hash_log}, {"--poses", options.poses},
                                     {"--scans", options.scans},       {"--summary", options.summary},
                                     {"--record", options.record},     {"--trace", options.trace.file},
                                     {"--journal", options.journal}};
  std::erase_if(outputs, [](const OutputName& output) { return output.path.empty(); });
  return outputs;
}

// A recording is a journal, too, which is cut where the run continues, and has files beside it.
bool IsJournal(const OutputName& output) {
  return output.option == "--journal" || output.path.ends_with(".mcap");
}

// A journal needs seeks and cuts, which a device or a pipe does not have.
Status CheckOutput(const OutputName& output) {
  const std::string& path = output.path;
  Status status = IsJournal(output) && IsDevice(path) && !std::filesystem::is_directory(path)
                      ? Failure("it is not a file, expected a regular file")
                      : CheckWritable(path);
  if (status.ok()) return status;
  return Error{{}, output.option + ": cannot write " + path + ": " + status.error().message};
}

}  // namespace

OutputParts::OutputParts(const std::string& output, const std::string& option) : option_(option) {
  std::error_code ignored;
  folder_ = IsDevice(output) ? std::filesystem::temp_directory_path(ignored).string()
                             : std::filesystem::absolute(output, ignored).parent_path().string();
}

OutputParts::~OutputParts() {
  for (int descriptor : descriptors_) close(descriptor);
}

// unlink at once: the open descriptor keeps the file, and the system frees it with the last process that has it open.
Result<std::string> OutputParts::Add() {
  AllowOpenFiles(descriptors_.size() + 1);
  std::string name = folder_ + "/troupe-part-XXXXXX";
  int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) return SystemError(option_ + ": cannot make a file in " + folder_);
  unlink(name.c_str());
  descriptors_.push_back(descriptor);
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(descriptor);
}

std::optional<Error> OutputFailure(const std::string& line, const std::string& path, const std::string& output) {
  const std::string start = path + ": error: ";
  const std::size_t at = line.find(start);
  if (path.empty() || at == std::string::npos || (at > 0 && line[at - 1] != ' ')) return std::nullopt;
  return Error{{output}, line.substr(at + start.size()), ErrorCode::kFailure};
}

// One pass over all parts, with one line of each in memory: the parts may be larger than the memory.
Status MergeScans(const std::vector<std::string>& parts, const std::string& output, LineFile::Space space) {
  std::vector<std::unique_ptr<Part>> open;
  for (const std::string& path : parts) {
    if (std::error_code unknown; !std::filesystem::exists(path, unknown) && !unknown) continue;
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

// The inputs are a function, since they need the files to be parsed: it is called only when an output exists already.
Status CheckOutputs(const RunOptions& options) {
  if (!options.journal.empty() && options.record.ends_with(".mcap")) {
    return Error{{}, "found --journal and a recording (--record), expected one of them: a recording is a journal, too"};
  }
  const std::vector<OutputName> outputs = OutputsOf(options);
  const auto inputs = [&options] {
    std::vector<std::string> files = InputFilesOf(options.file, options.load);
    for (const std::string& change : options.branch.controllers) {  // ROBOT=CONTROLLER:{...}
      std::string controller = change.substr(change.find('=') + 1);
      controller.resize(std::min(controller.find(":{"), controller.size()));
      if (NamesLibrary(controller)) files.push_back(ControllerFile(controller));
    }
    return files;
  };
  if (Status failure = CheckDistinct(outputs, inputs); !failure.ok()) return failure;
  for (const OutputName& output : outputs) {
    if (Status failure = CheckOutput(output); !failure.ok()) return failure;
  }
  return Status();
}

AgentOutput::AgentOutput(const std::string& option, const std::string& output)
    : option_(option), output_(output), parts_(output, option) {}

Status AgentOutput::AddParts(std::size_t count) {
  if (output_.empty()) return Status();
  for (std::size_t i = 0; i < count; ++i) {
    Result<std::string> file = parts_.Add();
    if (!file.ok()) return file.error();
    files_.push_back(std::move(file).value());
  }
  return Status();
}

std::string AgentOutput::PathOn(const Host& host, std::size_t part) const {
  if (host.folder().empty()) return files_[part];
  return host.folder() + "/agent" + option_ + "-" + std::to_string(part);
}

std::optional<Error> AgentOutput::FailureIn(const std::string& line, const Host& host) const {
  for (std::size_t part = 0; part < files_.size(); ++part) {
    std::optional<Error> failure = OutputFailure(line, PathOn(host, part), output_);
    if (failure && !host.name().empty()) failure->message = "on host " + host.name() + ": " + failure->message;
    if (failure) return failure;
  }
  return std::nullopt;
}

Status AgentOutput::Fetch(Host& host, std::size_t part, const FetchProgress& progress) const {
  if (host.folder().empty()) return Status();
  const Status fetched = host.Fetch(PathOn(host, part), files_[part], progress);
  return fetched.ok() ? fetched : Error{{output_}, fetched.error().message, ErrorCode::kFailure};
}

}  // namespace troupe
