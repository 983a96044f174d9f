// TickTrace: the phases of a program with their times, tick by tick, for the trace viewers of browsers (Chrome,
// Perfetto).
//
// Each thread that works on ticks has a lane, and on it one phase follows another. A phase belongs to the tick in
// progress: the agent's work on state n and the service's step from state n to n + 1 both belong to tick n + 1.
//
// The format is Chrome's trace events, an object on each line, so that a killed process leaves a usable file. Lanes
// collect phases in memory; files are written between ticks, on the owner's thread, because a write in the middle of a
// phase would be measured as part of it.
//
// Threads: a lane belongs to one thread at a time; TickTrace and TraceFile to their owner.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/enum_names.h"
#include "troupe/ids.h"
#include "troupe/result.h"

namespace troupe {

// TraceFile: a file in Chrome's trace format, an object on each line; and the merging of several.
class TraceFile {
 public:
  // `process`: its name in viewers.
  static Result<TraceFile> Create(const std::string& path, const std::string& process);

  // ns since 1970, so that the files of several hosts agree as well as their clocks. Never decreases.
  static std::int64_t Now();

  // A phase from `begin` to `end`, ns as of Now. `robot` may be empty. Writes nothing after an error.
  void Write(const char* name, std::size_t lane, std::int64_t begin, std::int64_t end, Tick tick,
             const std::string& robot);

  // The first error of a write (a full disk).
  const Status& status() const { return status_; }
  // Writes all buffered text. Returns status().
  Status Close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  TraceFile(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}
  void Fail();

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  Status status_;
};

// One file of several, with times from the first event on. Parts that do not exist, and last lines that were cut off,
// as by killed processes, are left out. Frees the space of the parts, so that the file fits even on a full disk.
Status MergeTraces(const std::vector<std::string>& parts, const std::string& output);

enum class TickPhase : std::uint8_t {
  kWait,     // service: for the proposals; agent: for the frame, with receiving and decoding it
  kStep,     // service: the next state and its hash
  kPublish,  // service: sending the frame
  kRecord,   // service: output files and ROS messages
  kApply,    // agent: applying the frame to the replica
  kSense,    // agent: a robot's measurements
  kDecide,   // agent: its controller, gripper and drive
  kSend,     // agent: sending the proposal
};
constexpr auto NamesOf(TickPhase) {
  return std::array{"wait", "step", "publish", "record", "apply", "sense", "decide", "send"};
}

struct TraceOptions {
  std::string file;  // empty: no trace
  Tick first = 0;    // ticks outside are left out
  std::optional<Tick> last;
};

// "FIRST:LAST", as on command lines; either may be left out.
Result<TraceOptions> ParseTraceTicks(const std::string& text);

// One thread's phases. Without a trace it costs no more than testing a pointer: `Enter` below.
class TraceLane {
 public:
  explicit TraceLane(const TraceOptions& options) : first_(options.first), last_(options.last) {}

  // Ends the open phase and begins this one. `robot`: the phase's robot; nothing: all of the process.
  void Enter(TickPhase phase, Tick tick, std::optional<RobotId> robot = std::nullopt);
  // Ends the open phase.
  void Leave();

 private:
  friend class TickTrace;
  struct Span {
    std::int64_t begin;  // ns, of the clock of TraceFile
    std::int64_t end;
    Tick tick;
    std::optional<RobotId> robot;
    TickPhase phase;
  };

  const Tick first_;
  const std::optional<Tick> last_;
  std::optional<Span> open_;
  std::vector<Span> done_;
};

inline void Enter(TraceLane* lane, TickPhase phase, Tick tick, std::optional<RobotId> robot = std::nullopt) {
  if (lane != nullptr) lane->Enter(phase, tick, robot);
}

class TickTrace {
 public:
  // `process`: its name in viewers.
  static Result<std::unique_ptr<TickTrace>> Create(const TraceOptions& options, const std::string& process);
  ~TickTrace();  // writes all
  TickTrace(const TickTrace&) = delete;
  TickTrace& operator=(const TickTrace&) = delete;

  // Names the robots, in id order.
  void NameRobots(std::vector<std::string> names) { robots_ = std::move(names); }
  // Valid as long as the trace.
  TraceLane* AddLane();

  // Writes if many phases are waiting. Returns the first error of a write so far. REQUIRES: no lane is in use.
  const Status& WriteSome();
  // Ends all phases and writes the file to its end. The error is that of the first write that failed (a full disk).
  Status Close();

 private:
  TickTrace(const TraceOptions& options, TraceFile file);
  void Write(std::size_t lane);

  const TraceOptions options_;
  TraceFile file_;
  std::vector<std::string> robots_;
  std::vector<std::unique_ptr<TraceLane>> lanes_;
};

// PhaseTimes: how long the phases of the service take in a tick, on average over about the last second.
//
// Threads: one at a time.
class PhaseTimes {
 public:
  // Ends the open phase and begins this one, at `now`, ns of a clock that never decreases. Each kStep begins a tick.
  void Enter(TickPhase phase, std::int64_t now = TraceFile::Now());
  // The time since Enter does not count: the phase in progress begins now.
  void Restart(std::int64_t now = TraceFile::Now());

  // s, of one tick: all parts of the phase together. 0 without ticks in the last seconds.
  double Mean(TickPhase phase, std::int64_t now = TraceFile::Now()) const;

 private:
  static constexpr std::size_t kPhases = 8;
  // The phases that ended within a stretch of time.
  struct Window {
    std::int64_t begin = 0;
    std::uint64_t ticks = 0;
    std::array<std::int64_t, kPhases> times = {};  // ns, by phase
  };

  std::optional<TickPhase> phase_;
  std::int64_t entered_ = 0;
  Window now_;
  Window before_;
};

// Notes the beginning of a phase in both, where they are not null.
inline void Enter(TraceLane* lane, PhaseTimes* times, TickPhase phase, Tick tick) {
  Enter(lane, phase, tick);
  if (times != nullptr) times->Enter(phase);
}

}  // namespace troupe
