// StateRows: the newest state of a world, row by row, with the number of the update that changed each row last. So the
// difference from any earlier update is known without keeping that state, for viewers that skip updates.
#pragma once

#include <cstdint>
#include <vector>

#include "troupe/world_state.h"
#include "viewer/gateway/byte_writer.h"

namespace troupe {

class StateRows {
 public:
  // `number` grows with each call. `fresh`: another world; all rows have changed.
  void Assign(const WorldState& state, std::uint64_t number, bool fresh);

  // Writes the rows of robots, joints, grippers, objects, stores and lights that have changed after update `since`;
  // 0: all.
  void Write(ByteWriter& writer, std::uint64_t since) const;

 private:
  WorldState state_;
  std::vector<std::uint64_t> robots_;  // the update of the last change, by row
  std::vector<std::uint64_t> joints_;
  std::vector<std::uint64_t> grippers_;
  std::vector<std::uint64_t> objects_;
  std::vector<std::uint64_t> stores_;
  std::vector<std::uint64_t> lights_;
};

}  // namespace troupe
