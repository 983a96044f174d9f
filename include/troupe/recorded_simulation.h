// RecordedSimulation: a recording (docs/recording.md) as a sequence of states. Each is a Simulation without
// controllers: its state, events and readings are the recorded ones, and it can be driven on from there.
//
// The states are stepped again from the recorded inputs, and compared with the recorded hashes: access in order is
// quickest, and near a state that was read last cheap in both directions.
//
// Threads: one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "troupe/ids.h"
#include "troupe/result.h"
#include "troupe/simulation.h"

namespace troupe {

class RecordedSimulation {
 public:
  // The error is a file that is no recording, one of another version of the step, or one without a readable tick.
  static Result<RecordedSimulation> Open(const std::string& file);

  RecordedSimulation(RecordedSimulation&& other) noexcept;
  RecordedSimulation& operator=(RecordedSimulation&& other) noexcept;
  ~RecordedSimulation();

  std::size_t size() const;  // the states, at least 1
  // Positions count the states from 0. Ticks ascend with them, but an edit keeps the tick or sets it back.
  // REQUIRES: position < size()
  Tick TickAt(std::size_t position) const;
  // The last state of a tick; nothing: there is none.
  std::optional<std::size_t> Find(Tick tick) const;
  // Why the states end before the run; nothing: they do not.
  const std::optional<std::string>& damage() const;
  // The version of the program that has recorded it, and the world's file as the run was given it.
  const std::string& program_version() const;
  const std::string& world_file() const;

  // The state at a position. The error is a damaged recording, or one whose states are others now.
  // REQUIRES: position < size()
  Result<Simulation> At(std::size_t position);

 private:
  struct Impl;
  explicit RecordedSimulation(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;  // null only after a move
};

}  // namespace troupe
