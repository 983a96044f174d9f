#include "common/trace/tick_trace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string_view>

#include "common/base/file.h"
#include "common/base/json_writer.h"
#include "common/base/or_failure.h"
#include "common/base/output_file.h"
#include "common/base/system_error.h"

namespace troupe {
namespace {

constexpr std::size_t kSpansKept = 16'384;  // of a lane, until they are written

// All of `text` as a tick.
std::optional<Tick> TickOf(std::string_view text) {
  Tick tick = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), tick);
  return failure == std::errc() && end == text.data() + text.size() ? std::optional(tick) : std::nullopt;
}

// An event begins with its time, so that it is easily parsed. Chrome counts in microseconds.
constexpr char kLineStart[] = "{\"ts\":";
constexpr std::size_t kStartLength = sizeof kLineStart - 1;

// In microseconds, with the nanoseconds behind the point.
std::string Microseconds(std::int64_t nanoseconds) {
  return fmt::format("{}.{:03}", nanoseconds / 1000, nanoseconds % 1000);
}

// Parses the result of Microseconds at the beginning of `text`, with the text after it.
struct EventTime {
  std::int64_t nanoseconds;
  const char* rest;
};
std::optional<EventTime> TimeOf(const std::string& line) {
  if (!line.starts_with(kLineStart)) return std::nullopt;
  const char* const end = line.data() + line.size();
  std::int64_t whole = 0;
  const auto point = std::from_chars(line.data() + kStartLength, end, whole);
  if (point.ec != std::errc() || point.ptr == end || *point.ptr != '.') return std::nullopt;
  std::int64_t thousandths = 0;
  const auto after = std::from_chars(point.ptr + 1, end, thousandths);
  if (after.ec != std::errc() || after.ptr != point.ptr + 4) return std::nullopt;
  return EventTime{whole * 1000 + thousandths, after.ptr};
}

// Calls visit(part, line) for all whole lines with an object, without the comma after it. Parts count from 1.
template <typename Visit>
Status ForEachLine(const std::vector<std::string>& parts, LineFile::Space space, Visit visit) {
  for (std::size_t part = 1; part <= parts.size(); ++part) {
    const std::string& path = parts[part - 1];
    if (std::error_code unknown; !std::filesystem::exists(path, unknown) && !unknown) continue;
    Result<LineFile> file = LineFile::Open(path, space);
    if (!file.ok()) return file.error();
    for (std::string line; file.value().Next(line);) {
      if (line.size() < 2 || line.front() != '{' || !line.ends_with("},")) continue;
      line.pop_back();
      visit(part, line);
    }
    if (!file.value().status().ok()) return file.value().status();
  }
  return Status();
}

// With another process number: two hosts may use the same number.
std::string Renumbered(const std::string& text, std::size_t process) {
  constexpr std::string_view kField = "\"pid\":";
  const std::size_t at = text.find(kField);
  if (at == std::string::npos) return text;
  const std::size_t number = at + kField.size();
  return text.substr(0, number) + std::to_string(process) + text.substr(std::min(text.find(',', number), text.size()));
}

// ns. The mean is over two windows: the last complete one and the one in progress.
constexpr std::int64_t kWindow = 500'000'000;
constexpr std::int64_t kOldest = 5'000'000'000;  // older windows say nothing about the present

}  // namespace

Result<TraceOptions> ParseTraceTicks(const std::string& text) {
  TraceOptions options;
  const std::size_t colon = text.find(':');
  const std::string_view first = std::string_view(text).substr(0, colon);
  const std::string_view last = colon == std::string::npos ? "?" : std::string_view(text).substr(colon + 1);
  const std::optional<Tick> first_tick = first.empty() ? Tick{0} : TickOf(first);
  if (!last.empty()) options.last = TickOf(last);
  if (!first_tick || (!last.empty() && !options.last) || (options.last && *options.last < *first_tick)) {
    return Error{{}, "found '" + text + "', expected the first and the last tick, as 100:120, 100: or :120"};
  }
  options.first = *first_tick;
  return options;
}

void TraceLane::Enter(TickPhase phase, Tick tick, std::optional<RobotId> robot) {
  const std::int64_t now = TraceFile::Now();
  if (open_) {
    open_->end = now;
    done_.push_back(*open_);
  }
  open_.reset();
  if (tick >= first_ && (!last_ || tick <= *last_)) open_ = Span{now, now, tick, robot, phase};
}

void TraceLane::Leave() {
  if (!open_) return;
  open_->end = TraceFile::Now();
  done_.push_back(*open_);
  open_.reset();
}

TickTrace::TickTrace(const TraceOptions& options, TraceFile file) : options_(options), file_(std::move(file)) {}

Result<std::unique_ptr<TickTrace>> TickTrace::Create(const TraceOptions& options, const std::string& process) {
  Result<TraceFile> file = TraceFile::Create(options.file, process);
  if (!file.ok()) return file.error();
  return std::unique_ptr<TickTrace>(new TickTrace(options, std::move(file).value()));
}

TickTrace::~TickTrace() {
  // An owner that needs the outcome has closed it before.
  (void)OrFailure([this] { return Close(); });
}

TraceLane* TickTrace::AddLane() {
  lanes_.push_back(std::make_unique<TraceLane>(options_));
  return lanes_.back().get();
}

void TickTrace::Write(std::size_t lane) {
  for (const TraceLane::Span& span : lanes_[lane]->done_) {
    const std::string robot = span.robot && span.robot->index() < robots_.size() ? robots_[span.robot->index()] : "";
    file_.Write(NameOf(span.phase), lane, span.begin, span.end, span.tick, robot);
  }
  lanes_[lane]->done_.clear();
}

const Status& TickTrace::WriteSome() {
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    if (lanes_[lane]->done_.size() >= kSpansKept) Write(lane);
  }
  return file_.status();
}

Status TickTrace::Close() {
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    lanes_[lane]->Leave();
    Write(lane);
  }
  return file_.Close();
}

std::int64_t TraceFile::Now() {
  using std::chrono::duration_cast;
  using std::chrono::nanoseconds;
  using Steady = std::chrono::steady_clock;
  // The offset is taken once: the system clock may be set back, phases must not end before they begin.
  static const std::int64_t offset = (std::chrono::system_clock::now().time_since_epoch() -
                                      duration_cast<nanoseconds>(Steady::now().time_since_epoch()))
                                         .count();
  return duration_cast<nanoseconds>(Steady::now().time_since_epoch()).count() + offset;
}

Result<TraceFile> TraceFile::Create(const std::string& path, const std::string& process) {
  Result<FileDescriptor> opened = OpenToWrite(path, O_TRUNC);
  if (!opened.ok())
    return Error{{path}, "cannot write a trace here: " + opened.error().message, ErrorCode::kOutputFailed};
  std::FILE* const file = fdopen(opened.value().get(), "w");
  if (file == nullptr) {
    return SystemError("cannot write a trace here", path, ErrorCode::kOutputFailed);
  }
  (void)opened.value().Release();  // the stream closes it
  TraceFile trace(path, file);
  // Viewers accept a list without its end, as of a program that is running or was killed.
  std::string line = "[\n";
  JsonWriter json(line);
  json.BeginObject().Member("name", "process_name").Member("ph", "M").Member("pid", getpid()).Key("args");
  json.BeginObject().Member("name", fmt::format("{} ({})", process, getpid())).EndObject().EndObject();
  fmt::print(file, "{},\n", line);
  return trace;
}

void TraceFile::Write(const char* name, std::size_t lane, std::int64_t begin, std::int64_t end, Tick tick,
                      const std::string& robot) {
  if (!file_ || !status_.ok()) return;
  std::string line;
  JsonWriter json(line);
  json.BeginObject().Key("ts").Raw(Microseconds(begin)).Key("dur").Raw(Microseconds(end - begin)).Member("name", name);
  json.Member("ph", "X").Member("pid", getpid()).Member("tid", lane).Key("args").BeginObject().Member("tick", tick);
  if (!robot.empty()) json.Member("robot", robot);
  json.EndObject().EndObject();
  line += ",\n";
  if (std::fwrite(line.data(), 1, line.size(), file_.get()) != line.size()) Fail();
}

void TraceFile::Fail() {
  status_ = SystemError("cannot write a trace", path_, ErrorCode::kOutputFailed);
  __fpurge(file_.get());  // a later attempt might write text behind a gap
}

Status TraceFile::Close() {
  if (file_ && status_.ok() && std::fflush(file_.get()) != 0) Fail();
  file_.reset();
  return status_;
}

Status MergeTraces(const std::vector<std::string>& parts, const std::string& output) {
  std::int64_t start = std::numeric_limits<std::int64_t>::max();
  const auto find_start = [&start](std::size_t, const std::string& line) {
    if (const std::optional<EventTime> time = TimeOf(line)) start = std::min(start, time->nanoseconds);
  };
  // Two passes, because times are counted from the first event of all files.
  if (Status unread = ForEachLine(parts, LineFile::Space::kKeep, find_start); !unread.ok()) return unread;
  Result<OutputFile> created = OutputFile::Create(output);
  if (!created.ok()) return created.error();
  OutputFile& file = created.value();
  const char* separator = "[";  // before the next line
  const auto copy = [&](std::size_t part, const std::string& line) {
    file.Append(separator);
    (void)file.EndLine();  // Close returns its error
    separator = ",";
    if (const std::optional<EventTime> time = TimeOf(line)) {
      file.Append(kLineStart + Microseconds(time->nanoseconds - start) + Renumbered(time->rest, part));
    } else {
      file.Append(Renumbered(line, part));
    }
  };
  Status unread = ForEachLine(parts, LineFile::Space::kFree, copy);
  file.Append(separator[0] == '[' ? "[]" : "\n]");
  (void)file.EndLine();  // Close returns its error
  Status closed = file.Close();
  return unread.ok() ? closed : unread;
}

void PhaseTimes::Enter(TickPhase phase, std::int64_t now) {
  if (phase_) now_.times[static_cast<std::size_t>(*phase_)] += now - entered_;
  // A window ends between two ticks, and slow ticks make long ones.
  if (phase == TickPhase::kWait && now_.ticks > 0 && now - now_.begin >= kWindow) {
    before_ = now_;
    now_ = {};
    now_.begin = now;
  }
  if (!phase_) now_.begin = now;
  if (phase == TickPhase::kStep) ++now_.ticks;
  phase_ = phase;
  entered_ = now;
}

void PhaseTimes::Restart(std::int64_t now) {
  entered_ = now;
}

double PhaseTimes::Mean(TickPhase phase, std::int64_t now) const {
  if (!phase_ || now - entered_ > kOldest) return 0.0;
  const std::uint64_t ticks = before_.ticks + now_.ticks;
  if (ticks == 0) return 0.0;
  const auto index = static_cast<std::size_t>(phase);
  return static_cast<double>(before_.times[index] + now_.times[index]) * 1e-9 / static_cast<double>(ticks);
}

}  // namespace troupe
