// StateRows: the newest state of a world, row by row, with the number of the update that changed each row last. So the
// difference from any earlier update is known without keeping that state, for viewers that skip updates.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "troupe/world_state.h"
#include "viewer/gateway/byte_writer.h"

namespace troupe {

class StateRows {
 public:
  // `number` grows with each call. `fresh`: another world; all rows have changed.
  void Assign(std::shared_ptr<const WorldState> state, std::uint64_t number, bool fresh);

  // Writes the rows that are on the page (kIsOnPage) and have changed after update `since`; 0: all.
  void Write(ByteWriter& writer, std::uint64_t since) const;

 private:
  std::shared_ptr<const WorldState> state_ = std::make_shared<const WorldState>();
  // The update of the last change, by row; in the order of the fields of WorldState.
  std::array<std::vector<std::uint64_t>, std::tuple_size_v<decltype(kFields<WorldState>)>> changed_;
};

}  // namespace troupe
