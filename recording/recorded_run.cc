// Records of runs, edits and ticks as bytes: the messages of idl/ in CDR, by the same conversions as on the network, so
// that a recording needs no second description of a world or a state. Reading checks as much as receiving from a peer
// does.
#include "idl/recorded_run.h"

#include <cmath>
#include <limits>
#include <utility>

#include "idl/recorded_edit.h"
#include "idl/recorded_tick.h"
#include "recording/recorded_run.h"
#include "transport/dds/convert/columns.h"
#include "transport/dds/convert/convert.h"
#include "transport/wire/cdr.h"
#include "troupe/check.h"

TROUPE_DDS_TYPE(troupe_wire_RecordedEdit);
TROUPE_DDS_TYPE(troupe_wire_RecordedRun);
TROUPE_DDS_TYPE(troupe_wire_RecordedTick);

namespace troupe {
namespace {

constexpr auto kEventLeaves = dds::WithoutFirst(kLeaves<Event>);  // the tick is that of the recorded tick

Result<RunSettings> SettingsFromWire(const troupe_wire_RecordedRun& wire) {
  if (static_cast<Mode>(wire.mode) > LastOf(Mode()) ||
      static_cast<OnAgentLoss>(wire.on_agent_loss) > LastOf(OnAgentLoss())) {
    return BadInput("recorded run with an unknown mode or on_agent_loss");
  }
  if (!(std::isfinite(wire.speed) && wire.speed >= 0.0 && wire.agent_deadline >= 0.0)) {
    return BadInput("recorded run with a speed or deadline that is negative or not finite");
  }
  RunSettings settings;
  if (wire.ticks > 0) settings.ticks = wire.ticks;
  settings.mode = static_cast<Mode>(wire.mode);
  if (wire.speed > 0.0) settings.speed = settings.watched_speed = wire.speed;
  settings.on_agent_loss = static_cast<OnAgentLoss>(wire.on_agent_loss);
  settings.robots_per_process = wire.robots_per_process;
  settings.restart_agents = wire.restart_agents;
  settings.agent_deadline_seconds = wire.agent_deadline;
  settings.ros = wire.ros;
  return settings;
}

}  // namespace

std::vector<std::byte> RunToBytes(const RecordedRun& run) {
  dds::WireArena arena;
  troupe_wire_RecordedRun wire{};
  wire.run = run.run;
  wire.program_version = arena.Copy(run.program_version);
  wire.step_version = run.step_version;
  wire.file = arena.Copy(run.file);
  wire.keyframe_interval = run.keyframe_interval;
  // 0 stands for "no limit" on the wire.
  wire.ticks = run.settings.ticks.value_or(0);
  wire.mode = static_cast<std::uint8_t>(run.settings.mode);
  wire.speed = run.settings.speed.value_or(0.0);
  wire.on_agent_loss = static_cast<std::uint8_t>(run.settings.on_agent_loss);
  wire.robots_per_process = run.settings.robots_per_process;
  wire.restart_agents = run.settings.restart_agents;
  wire.agent_deadline = run.settings.agent_deadline_seconds;
  wire.ros = run.settings.ros;
  wire.world = dds::ToWire(run.world, arena);
  auto* expectation = arena.Fill(wire.expectations, run.expectations.size());
  for (const NamedExpectation& each : run.expectations) {
    expectation->name = arena.Copy(each.name);
    expectation->text = arena.Copy(each.text);
    ++expectation;
  }
  auto* region = arena.Fill(wire.regions, run.regions.size());
  for (const NamedRegion& each : run.regions) {
    region->name = arena.Copy(each.name);
    double* coordinate = arena.Fill(region->outline, 2 * each.outline.size());
    for (const Vec2& vertex : each.outline) {
      *coordinate++ = vertex.x();
      *coordinate++ = vertex.y();
    }
    region->has_z = each.z.has_value();
    region->z = each.z.value_or(0.0);
    ++region;
  }
  return wire::ToCdr(wire);
}

Result<RecordedRun> RunFromBytes(std::span<const std::byte> bytes) {
  const auto sample = wire::FromCdr<troupe_wire_RecordedRun>(bytes);
  if (!sample.ok()) return sample.error();
  const troupe_wire_RecordedRun& wire = sample.value().data();
  Result<RunSettings> settings = SettingsFromWire(wire);
  if (!settings.ok()) return settings.error();
  Result<WorldDescription> world = dds::FromWire(wire.world);
  if (!world.ok()) return world.error();
  RecordedRun run;
  run.run = wire.run;
  run.program_version = dds::Text(wire.program_version);
  run.step_version = wire.step_version;
  run.file = dds::Text(wire.file);
  run.keyframe_interval = wire.keyframe_interval;
  run.settings = std::move(settings).value();
  run.world = std::move(world).value();
  for (const auto& each : dds::Elements(wire.expectations)) {
    run.expectations.push_back({dds::Text(each.name), dds::Text(each.text)});
  }
  for (const auto& each : dds::Elements(wire.regions)) {
    const auto coordinates = dds::Elements(each.outline);
    Polygon corners;
    for (std::size_t i = 0; i + 1 < coordinates.size(); i += 2) {
      corners.emplace_back(coordinates[i], coordinates[i + 1]);
    }
    Result<Polygon> outline = Normalized(std::move(corners));
    if (!outline.ok() || coordinates.size() % 2 != 0 || !std::isfinite(each.z)) {
      return BadInput("recorded run with a region that is no polygon");
    }
    NamedRegion& region = run.regions.emplace_back();
    region.name = dds::Text(each.name);
    region.outline = std::move(outline).value();
    if (each.has_z) region.z = each.z;
  }
  return run;
}

std::vector<std::byte> EditToBytes(const RecordedEdit& edit) {
  dds::WireArena arena;
  troupe_wire_RecordedEdit wire{};
  wire.before = dds::ToWire(edit.before, arena);
  wire.request = dds::ToWire(ControlRequest{.request = edit.request}, arena);
  troupe_wire_World* world = arena.Fill(wire.world, (edit.world ? 1U : 0U) + (edit.original ? 1U : 0U));
  if (edit.world) *world++ = dds::ToWire(*edit.world, arena);
  if (edit.original) *world = dds::ToWire(*edit.original, arena);
  troupe_wire_Frame* const restored = arena.Fill(wire.restored, edit.restored ? 1 : 0);
  if (edit.restored) *restored = dds::ToWire(*edit.restored, arena);
  wire.copies = edit.copies;
  wire.copied_from = edit.copied_from;
  return wire::ToCdr(wire);
}

Result<RecordedEdit> EditFromBytes(std::span<const std::byte> bytes) {
  const auto sample = wire::FromCdr<troupe_wire_RecordedEdit>(bytes);
  if (!sample.ok()) return sample.error();
  const troupe_wire_RecordedEdit& wire = sample.value().data();
  RecordedEdit edit;
  if (!wire.before.whole) return BadInput("recorded edit with a frame of changes, expected a whole one");
  if (Status broken = dds::FromWire(wire.before, edit.before); !broken.ok()) return broken.error();
  Result<ControlRequest> request = dds::FromWire(wire.request);
  if (!request.ok()) return request.error();
  edit.request = std::move(request.value().request);
  // The second is the world as loaded.
  const std::uint32_t most = control::Is<control::Rewind>(edit.request) ? 2 : 1;
  if (wire.world._length > most) return BadInput("recorded edit with too many worlds");
  for (const troupe_wire_World& world : dds::Elements(wire.world)) {
    Result<WorldDescription> description = dds::FromWire(world);
    if (!description.ok()) return description.error();
    (edit.world ? edit.original : edit.world) = std::move(description).value();
  }
  edit.copies = wire.copies;
  edit.copied_from = wire.copied_from;
  if (wire.restored._length > 1) return BadInput("recorded edit with several restored states");
  for (const troupe_wire_Frame& frame : dds::Elements(wire.restored)) {
    if (!frame.whole) return BadInput("recorded edit with a frame of changes, expected a whole one");
    if (Status broken = dds::FromWire(frame, edit.restored.emplace()); !broken.ok()) return broken.error();
  }
  return edit;
}

std::vector<std::byte> TickToBytes(const RecordedTick& tick) {
  dds::WireArena arena;
  troupe_wire_RecordedTick wire{};
  wire.number = tick.number;
  wire.tick = tick.tick;
  wire.edition = tick.edition;
  wire.state_hash = tick.state_hash;
  troupe_wire_RecordedEvent* out = arena.Fill(wire.events, tick.events.size());
  for (const Event& event : tick.events) {
    dds::ForEachColumn(kEventLeaves, dds::MembersOf(*out++), [&]<typename Cell>(const auto& leaf, Cell& cell) {
      cell = dds::ToCell<Cell>(leaf.Of(event), arena);
    });
  }
  troupe_wire_RobotCommand* const commands = arena.Fill(wire.commands, tick.commands.size());
  for (std::size_t i = 0; i < tick.commands.size(); ++i) commands[i] = dds::ToWire(tick.commands[i], arena);
  wire.inputs = dds::ToWire(tick.inputs, arena);
  return wire::ToCdr(wire);
}

Status TickFromBytes(std::span<const std::byte> bytes, RecordedTick& tick) {
  const auto sample = wire::FromCdr<troupe_wire_RecordedTick>(bytes);
  if (!sample.ok()) return sample.error();
  const troupe_wire_RecordedTick& wire = sample.value().data();
  tick.number = wire.number;
  tick.tick = wire.tick;
  tick.edition = wire.edition;
  tick.state_hash = wire.state_hash;
  tick.events.clear();
  for (const troupe_wire_RecordedEvent& event : dds::Elements(wire.events)) {
    tick.events.push_back({.tick = wire.tick});
    bool is_known = true;
    dds::ForEachColumn(kEventLeaves, dds::MembersOf(event), [&](const auto& leaf, const auto& cell) {
      is_known &= dds::FromCell(cell, leaf.Of(tick.events.back()));
    });
    if (!is_known) return BadInput("recorded tick with an event of an unknown type or id");
  }
  tick.commands.clear();
  for (const troupe_wire_RobotCommand& element : dds::Elements(wire.commands)) {
    Result<RobotCommand> command = dds::FromWire(element);
    if (!command.ok()) return command.error();
    tick.commands.push_back(std::move(command).value());
  }
  return dds::FromWire(wire.inputs, tick.inputs);
}

mcap::Schema SchemaOf(const ChannelType& channel) {
  for (std::size_t i = 0; i < kIdlTextCount; ++i) {
    if (std::string_view(kIdlTexts[i].file) != channel.file) continue;
    return {channel.type, "omgidl", kIdlTexts[i].text};
  }
  TROUPE_CHECK(false);  // the build embeds all of them
  return {};
}

}  // namespace troupe
