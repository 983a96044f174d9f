// The messages to the page: the rows of a state that changed, and the world.
//
// Binary and little-endian, because a world of ten thousand robots at 60 updates a second is too much for JSON. The
// values and their readers in TypeScript come from the field lists of the types (page_values.h), so both sides cannot
// disagree; the layout has a hash (page_layout.h), and a page of another layout is asked to reload.
//
// Numbers of poses are doubles as in the state, twists are floats: the page shows them and calculates nothing with
// them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/world_state.h"

namespace troupe {

class PageWriter;

// The rows that the page shows. Of the others, lists that vary have no rows by id, and former velocities explain
// nothing.
template <typename Row>
inline constexpr bool kIsShownTable = !std::is_same_v<Row, ImuState> && !kIsVaryingTable<Row>;

// StateRows: the newest state of a world, row by row, with the number of the update that changed each row last. So the
// difference from any earlier update is known without keeping that state, for viewers that skip updates. Costs one
// comparison of each row per update, whatever the number of viewers.
class StateRows {
 public:
  // `number` grows with each call. `fresh`: another world; all rows have changed.
  void Assign(std::shared_ptr<const WorldState> state, std::uint64_t number, bool fresh);

  // Writes the rows that are on the page (kIsShownTable) and have changed after update `since`; 0: all.
  void Write(PageWriter& writer, std::uint64_t since) const;

 private:
  // Compared row by row with the next state.
  std::shared_ptr<const WorldState> state_ = std::make_shared<const WorldState>();
  // The update of the last change, by row; in the order of the fields of WorldState.
  std::array<std::vector<std::uint64_t>, std::tuple_size_v<decltype(kFields<WorldState>)>> changed_;
};

// The world message: the description of a world for the page, once for each edition.

// The first byte of each binary message to the page.
enum class PageMessage : std::uint8_t { kWorld = 1, kUpdate = 2 };

// A dense bitmap is sent with at most this many pixels along each side; beyond that a pixel of the page stands for
// several, and is occupied if one of them is.
inline constexpr int kMaxArea = 2048;

// The bytes of the message. `number`: of the world, counted by the gateway; the updates of the world repeat it.
std::string EncodeWorld(const SessionMessage& session, std::uint32_t number);

}  // namespace troupe
