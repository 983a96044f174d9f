#include "common/trace/tick_trace.h"

#include <charconv>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kSpansKept = 16'384;  // of a lane, until they are written

// All of `text` as a tick.
std::optional<Tick> TickOf(std::string_view text) {
  Tick tick = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), tick);
  return failure == std::errc() && end == text.data() + text.size() ? std::optional(tick) : std::nullopt;
}

}  // namespace

const char* ToString(TickPhase phase) {
  switch (phase) {
    case TickPhase::kWait:
      return "wait";
    case TickPhase::kStep:
      return "step";
    case TickPhase::kPublish:
      return "publish";
    case TickPhase::kRecord:
      return "record";
    case TickPhase::kApply:
      return "apply";
    case TickPhase::kSense:
      return "sense";
    case TickPhase::kDecide:
      return "decide";
    case TickPhase::kSend:
      return "send";
  }
  return "?";
}

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
  (void)Close();  // an owner that needs the outcome has closed it before
}

TraceLane* TickTrace::AddLane() {
  lanes_.push_back(std::make_unique<TraceLane>(options_));
  return lanes_.back().get();
}

void TickTrace::Write(std::size_t lane) {
  for (const TraceLane::Span& span : lanes_[lane]->done_) {
    const std::string robot = span.robot && span.robot->index() < robots_.size() ? robots_[span.robot->index()] : "";
    file_.Write(ToString(span.phase), lane, span.begin, span.end, span.tick, robot);
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

}  // namespace troupe
