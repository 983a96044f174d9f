#include "transport/dds/convert/convert_history.h"

#include <algorithm>
#include <utility>

#include "transport/dds/convert/convert_frame.h"
#include "transport/dds/convert/convert_world.h"

namespace troupe::dds {
namespace {

// The state that the frame of an entry can be written as changes of; null: none.
const WorldState* BaseOf(const HistoryEntry& entry, const HistoryEntry* before) {
  if (before == nullptr || entry.frame.edition != before->frame.edition ||
      entry.frame.state.tick != before->frame.state.tick + 1 || entry.frame.run != before->frame.run) {
    return nullptr;
  }
  const WorldState& a = entry.frame.state;
  const WorldState& b = before->frame.state;
  const bool same_rows = a.robots.size() == b.robots.size() && a.joints.size() == b.joints.size() &&
                         a.grippers.size() == b.grippers.size() && a.objects.size() == b.objects.size();
  return same_rows ? &b : nullptr;
}

}  // namespace

troupe_wire_History ToWire(const HistoryMessage& message, WireArena& arena) {
  troupe_wire_History wire{};
  wire.run = message.run;
  wire.incarnation = message.incarnation;
  std::copy(message.agents.begin(), message.agents.end(), arena.Fill(wire.agents, message.agents.size()));
  wire.follows = message.after.has_value();
  if (message.after) {
    wire.after_edition = message.after->edition;
    wire.after_tick = message.after->tick;
    wire.after_decided = message.after->decided;
  }
  troupe_wire_HistoryEntry* out = arena.Fill(wire.entries, message.entries.size());
  const HistoryEntry* before = nullptr;
  for (const HistoryEntry& entry : message.entries) {
    out->frame = ToWire(entry.frame, BaseOf(entry, before), arena);
    out->step_follows = entry.step_follows;
    if (entry.world) *arena.Fill(out->world, 1) = ToWire(*entry.world, arena);
    before = &entry;
    ++out;
  }
  return wire;
}

Result<HistoryMessage> FromWire(const troupe_wire_History& wire) {
  HistoryMessage message;
  message.run = wire.run;
  message.incarnation = wire.incarnation;
  const auto agents = Elements(wire.agents);
  message.agents.assign(agents.begin(), agents.end());
  if (wire.follows) message.after = {wire.after_edition, wire.after_tick, wire.after_decided};
  FrameMessage frame;
  for (const troupe_wire_HistoryEntry& from : Elements(wire.entries)) {
    if (!CanRead(from.frame, frame)) return Error{{}, "history with a frame of changes that does not follow"};
    if (Status malformed = FromWire(from.frame, frame); !malformed.ok()) return malformed.error();
    HistoryEntry& entry = message.entries.emplace_back();
    entry.frame = frame;
    entry.step_follows = from.step_follows;
    const auto worlds = Elements(from.world);
    if (worlds.size() > 1) return Error{{}, "history with several worlds of one state"};
    if (worlds.empty()) continue;
    Result<WorldDescription> world = FromWire(worlds[0]);
    if (!world.ok()) return world.error();
    entry.world = std::move(world).value();
  }
  if (message.entries.empty()) return Error{{}, "history without a state"};
  return message;
}

}  // namespace troupe::dds
