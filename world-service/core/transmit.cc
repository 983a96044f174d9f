#include "world-service/core/transmit.h"

#include <vector>

#include "troupe/radio_limits.h"

namespace troupe {

void Transmit(const WorldDescription& world, std::span<const Proposal* const> by_robot, WorldState& state) {
  std::erase_if(state.transmissions,
                [&](const RadioTransmission& transmission) { return transmission.due < state.tick; });
  for (const Proposal* const proposal : by_robot) {
    if (proposal == nullptr) continue;
    std::size_t number = 0;
    for (const RadioMessage& message : proposal->messages) {
      const RadioParameters* const radio = FindRadio(world.robot(proposal->robot), message.radio);
      state.transmissions.push_back({.from = proposal->robot,
                                     .sent = state.tick,
                                     .due = state.tick + DelayTicks(*radio, world.interval_seconds()),
                                     .number = number++,
                                     .message = message});
    }
  }
}

}  // namespace troupe
