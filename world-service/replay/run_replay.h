// RunReplay: steps a recorded run again, from its recorded inputs and without controllers, and compares every state
// with the recorded hash.
//
// A difference means that this program steps otherwise than the one that recorded, on this machine: a fault of the
// simulator, never of the user's controllers, which are not run. Damage of the file is reported apart from it, with the
// states that were compared before.
//
// Whatever follows the states of a recording (replays, exports, expectations) does it by this class.
// Outputs (hash log, poses, scans) are those that the run itself would have written, byte by byte, because sensors are
// pure functions of state, seed and tick. Passive: the calling thread does all the work.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/output_file.h"
#include "common/sensing/sensor.h"
#include "recording/recording.h"
#include "troupe/result.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

// The file of --scans of a replay, with the lines that the agents of the run wrote.
class ScanWriter {
 public:
  static Result<ScanWriter> Create(const std::string& path);

  // Measures all sensors of all robots that are due, in the order of robots and sensors.
  Status Write(const ReplayedWorld& world);
  // The robots that were rebuilt at this edition have no line: as at the start of the run.
  void Begin(Edition fresh_edition) { fresh_edition_ = fresh_edition; }
  Status Close() { return file_.Close(); }

 private:
  explicit ScanWriter(OutputFile file) : file_(std::move(file)) {}

  OutputFile file_;
  std::shared_ptr<const Scene> scene_;  // of the sensors
  std::vector<std::unique_ptr<const Sensor>> sensors_;
  Edition fresh_edition_ = 0;  // of the newest line
};

struct ReplayOptions {
  // The first and the last tick. Of a tick with several states, because of edits, `from` is the first and `to` the
  // last. Nothing: the recording's.
  std::optional<Tick> from;
  std::optional<Tick> to;
  bool compare_events = false;
  OutputFiles outputs;  // hash log and poses
  std::string scans;    // file; empty: none
  // Called with each state from the start of the run, and the tick that follows it; returns a difference. Its error
  // ends the replay. May be null.
  std::function<Result<std::optional<std::string>>(const ReplayedWorld& world, const RecordedTick& next)> check;
  // Called with each state of the range that was compared, but for states within a rewind, which the run has not
  // published, and the tick that led to it. Its error ends the replay. May be null.
  std::function<Status(const ReplayedWorld& world, const RecordedTick& tick)> on_state;
  // Called now and then with the tick and the share of the ticks, 0 to 1. May be null.
  std::function<void(Tick tick, double share)> on_progress;
};

struct ReplayReport {
  std::uint64_t states = 0;  // that were compared without a difference
  Tick first = 0;            // the ticks of the first and the last of these
  Tick last = 0;
  std::uint64_t state_hash = 0;           // of the last
  std::optional<std::string> difference;  // the first
  std::optional<std::string> damage;      // of the recording: the states after it were not compared
};

class RunReplay {
 public:
  // The recording outlives the replay.
  RunReplay(const Recording& recording, ReplayOptions options) : recording_(recording), options_(std::move(options)) {}

  // The error is a tick that the recording does not have, or an output file.
  Result<ReplayReport> Run();

 private:
  Status FindRange();
  Status CreateOutputs();
  Status CreateRecorder(const OutputFiles& files);
  Status CloseOutputs();
  Status RunTicks();
  bool IsInRange(std::uint64_t position) const { return position >= from_ && position <= to_; }
  // Goes to the state of the next tick, after options_.check. False at a difference, or damage.
  Result<bool> Advance();
  // Notes and writes the state. The error is that of an output file.
  Status AddState();
  bool HasEqualEvents() const;
  bool IsMisplaced() const;  // the state, in a file whose times are damaged
  // Ends the replay.
  Status Damaged(const std::string& problem) {
    report_.damage = problem;
    return {};
  }
  // After a difference that names no model: steps on to the next recorded state, which does.
  void FindModel();
  Status WriteOutputs();
  void ReportProgress(const RecordedTick& tick);

  const Recording& recording_;
  const ReplayOptions options_;
  std::uint64_t from_ = 0;  // positions
  std::uint64_t to_ = 0;
  std::optional<ReplayCursor> cursor_;
  std::unique_ptr<Recorder> recorder_;           // null: no hash log and no poses
  std::shared_ptr<const Scene> recorded_scene_;  // known to recorder_
  std::optional<ScanWriter> scans_;
  FrameMessage frame_;  // for recorder_
  ReplayReport report_;
};

}  // namespace troupe
