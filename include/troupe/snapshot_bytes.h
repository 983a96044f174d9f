// SnapshotBytes: a snapshot as bytes, for another process of the same version of Troupe, or for a file.
//
// They have the world, the state and the motions that robots are driven by. The memory of a controller is its own
// matter, so that only robots without one can be written, and none with joints, whose motors know the last commands.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "troupe/result.h"
#include "troupe/simulation.h"

namespace troupe {

class SnapshotBytes {
 public:
  // The error names the robot that cannot be written, or commands that wait for the next step.
  static Result<std::vector<std::byte>> Write(const Snapshot& snapshot);
  // The same steps from it give the same hashes. Any bytes are safe; the error is one of another version, or bytes that
  // are none of Write.
  static Result<Snapshot> Read(std::span<const std::byte> bytes);

 private:
  static Status CheckWritable(const Snapshot& snapshot);
};

}  // namespace troupe
