// Frames as columns: a list for each field of each table, so that equal types are packed without padding and a frame of
// changes sends the columns and rows that have changed. A frame of changes refers to the state one tick earlier of the
// same run and edition; the receiver must have exactly this one (CanRead).
//
// The lists of fields (troupe/fields.h) pair with the members of the IDL structures in order, checked by static_assert:
// a new field without a column does not compile. Everything from the wire is checked: row numbers, lengths of columns,
// enumerators, ids of robots.
#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "common/model/states.h"
#include "transport/dds/convert/columns.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/convert/structs.h"

namespace troupe::dds {
namespace {

// Compares bits: -0.0 differs from 0.0, because a replica must have the same bits.
template <typename Part>
bool IsSame(const Part& a, const Part& b) {
  if constexpr (std::is_same_v<Part, double>) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else {
    return a == b;
  }
}

// The rows that have changed since `before`, which has as many; all if it is null. `rows` and `column_changed` are in
// the order of the ids and of the leaves.
template <typename Row>
struct Changes {
  Changes(const std::vector<Row>& now, const std::vector<Row>* before) {
    std::vector<bool> row_changed(now.size(), before == nullptr);
    ForEachLeaf<Row>([&](const auto& leaf) {
      bool changed = before == nullptr;
      for (std::size_t i = 0; i < now.size() && before != nullptr; ++i) {
        if (IsSame(leaf.Of(now[i]), leaf.Of((*before)[i]))) continue;
        row_changed[i] = true;
        changed = true;
      }
      column_changed.push_back(changed);
    });
    for (std::size_t i = 0; i < row_changed.size(); ++i) {
      if (row_changed[i]) rows.push_back(static_cast<std::uint32_t>(i));
    }
  }

  std::vector<std::uint32_t> rows;
  std::vector<bool> column_changed;
};

// `columns`: the numbers of the rows, then a column for each leaf.
template <typename Row, typename Columns>
void RowsToWire(const std::vector<Row>& now, const std::vector<Row>* before, Columns& columns, WireArena& arena) {
  if (now.empty()) return;
  const Changes<Row> changes(now, before);
  const auto members = MembersOf(columns);
  if (changes.rows.size() < now.size()) {
    std::copy(changes.rows.begin(), changes.rows.end(), arena.Fill(std::get<0>(members), changes.rows.size()));
  }
  std::size_t next_column = 0;
  ForEachColumn(kLeaves<Row>, WithoutFirst(members), [&]<typename Column>(const auto& leaf, Column& column) {
    if (!changes.column_changed[next_column++]) return;
    auto* out = arena.Fill(column, changes.rows.size());
    for (const std::uint32_t row : changes.rows) *out++ = ToCell<CellOf<Column>>(leaf.Of(now[row]), arena);
  });
}

template <typename Row, typename Columns>
Status RowsFromWire(std::string_view what, const Columns& columns, bool whole, std::vector<Row>& rows) {
  const auto members = MembersOf(columns);
  const auto numbers = Elements(std::get<0>(members));
  const char* problem = whole && !numbers.empty() ? "row numbers though it is whole" : nullptr;
  for (const std::uint32_t number : numbers) {
    if (number >= rows.size()) problem = "a row that the world does not have";
  }
  if (whole) rows.resize(Elements(std::get<1>(members)).size());
  ForEachColumn(kLeaves<Row>, WithoutFirst(members), [&](const auto& leaf, const auto& column) {
    const auto cells = Elements(column);
    if (problem != nullptr || (!whole && cells.empty())) return;  // of which nothing has changed
    if (cells.size() != (numbers.empty() ? rows.size() : numbers.size())) {
      problem = "columns of different lengths";
      return;
    }
    bool is_fine = true;
    if (numbers.empty()) {
      for (std::size_t i = 0; i < cells.size(); ++i) is_fine &= FromCell(cells[i], leaf.Of(rows[i]));
    } else {
      for (std::size_t i = 0; i < cells.size(); ++i) is_fine &= FromCell(cells[i], leaf.Of(rows[numbers[i]]));
    }
    if (!is_fine) problem = "a value that is not known";
  });
  if (problem == nullptr) return {};
  return Error{{}, "frame with " + std::string(problem) + ", for its " + std::string(what)};
}

// Calls visit(table, columns) for each list of rows.
template <typename StateColumns, typename Visit>
void ForEachTableWithColumns(StateColumns& state, const Visit& visit) {
  constexpr auto tables = WithoutFirst(kFields<WorldState>);  // the tick is a number of the frame
  const auto columns = MembersOf(state);
  static_assert(std::tuple_size_v<decltype(tables)> == std::tuple_size_v<decltype(columns)>);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (visit(std::get<I>(tables), std::get<I>(columns)), ...);
  }
  (std::make_index_sequence<std::tuple_size_v<decltype(columns)>>());
}

void StateToWire(const WorldState& now, const WorldState* before, troupe_wire_StateColumns& wire, WireArena& arena) {
  ForEachTableWithColumns(wire, [&]<typename Row>(const Field<WorldState, std::vector<Row>>& table, auto& columns) {
    const std::vector<Row>& rows = table.Of(now);
    if constexpr (kIsVaryingTable<Row>) {
      const auto for_each_row = [&](const auto& use) { std::for_each(rows.begin(), rows.end(), use); };
      ListToColumns(rows.size(), for_each_row, kLeaves<Row>, MembersOf(columns), arena);
    } else {
      RowsToWire(rows, before == nullptr ? nullptr : &table.Of(*before), columns, arena);
    }
  });
}

Status StateFromWire(const troupe_wire_StateColumns& wire, bool whole, WorldState& state) {
  Status problem;
  ForEachTableWithColumns(
      wire, [&]<typename Row>(const Field<WorldState, std::vector<Row>>& table, const auto& columns) {
        if (!problem.ok()) return;
        if constexpr (kIsVaryingTable<Row>) {
          problem = ListFromColumns("frame of a list", kLeaves<Row>, MembersOf(columns), table.Of(state));
        } else {
          problem = RowsFromWire(table.name, columns, whole, table.Of(state));
        }
      });
  return problem;
}

constexpr auto kEventLeaves = WithoutFirst(kLeaves<Event>);  // the tick is that of the frame

Status EventsFromWire(const troupe_wire_Frame& wire, std::size_t robots, std::vector<Event>& events) {
  if (Status problem = ListFromColumns("frame of events", kEventLeaves, MembersOf(wire.events), events);
      !problem.ok()) {
    return problem;
  }
  for (Event& event : events) {
    event.tick = wire.tick;
    if (event.robot && event.robot->index() >= robots) {
      return Error{{}, "frame with an event of robot " + std::to_string(event.robot->index()) + ", which is unknown"};
    }
  }
  return {};
}

Status CommandsFromWire(const troupe_wire_Frame& wire, std::size_t robots, std::vector<RobotCommand>& commands) {
  commands.clear();
  for (const troupe_wire_RobotCommand& element : Elements(wire.commands)) {
    if (element.robot >= robots || (!commands.empty() && element.robot <= commands.back().robot.index())) {
      return Error{{}, "frame with a command of robot " + std::to_string(element.robot) + ", expected ascending ids"};
    }
    Result<RobotCommand> command = dds::FromWire(element);
    if (!command.ok()) return command.error();
    commands.push_back(std::move(command).value());
  }
  return {};
}

// The state that the frame of an entry can be written as changes of; null: none.
const WorldState* BaseOf(const HistoryEntry& entry, const HistoryEntry* before) {
  if (before == nullptr || entry.frame.edition != before->frame.edition ||
      entry.frame.state.tick != before->frame.state.tick + 1 || entry.frame.run != before->frame.run) {
    return nullptr;
  }
  // A table with another number of rows has no base row by row.
  const WorldState& a = entry.frame.state;
  const WorldState& b = before->frame.state;
  return HaveSameRows(a, b) ? &b : nullptr;
}

}  // namespace

troupe_wire_Frame ToWire(const FrameMessage& message, const WorldState* before, WireArena& arena) {
  troupe_wire_Frame wire{};
  wire.run = message.run;
  wire.tick = message.state.tick;
  wire.state_hash = message.state_hash;
  wire.last = message.last;
  wire.paused = message.paused;
  wire.holds = message.holds;
  wire.edition = message.edition;
  wire.world_edition = message.world_edition;
  wire.fresh_edition = message.fresh_edition;
  wire.incarnation = message.incarnation;
  wire.remembered = message.remembered;
  std::copy(message.awaited.begin(), message.awaited.end(), arena.Fill(wire.awaited, message.awaited.size()));
  wire.whole = before == nullptr;
  StateToWire(message.state, before, wire.state, arena);
  const auto for_each_event = [&](const auto& use) {
    std::for_each(message.events.begin(), message.events.end(), use);
  };
  ListToColumns(message.events.size(), for_each_event, kEventLeaves, MembersOf(wire.events), arena);
  troupe_wire_RobotCommand* commands = arena.Fill(wire.commands, message.commands.size());
  for (const RobotCommand& command : message.commands) *commands++ = ToWire(command, arena);
  return wire;
}

troupe_wire_Frame ToWire(const FrameMessage& message, WireArena& arena) {
  return ToWire(message, nullptr, arena);
}

bool CanRead(const troupe_wire_Frame& wire, const FrameMessage& message) {
  return wire.whole ||
         (message.run == wire.run && message.edition == wire.edition && message.state.tick + 1 == wire.tick);
}

Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message) {
  message.run = wire.run;
  message.state.tick = wire.tick;
  message.state_hash = wire.state_hash;
  message.last = wire.last;
  message.paused = wire.paused;
  message.holds = wire.holds;
  message.edition = wire.edition;
  message.world_edition = wire.world_edition;
  message.fresh_edition = wire.fresh_edition;
  message.incarnation = wire.incarnation;
  message.remembered = wire.remembered;
  const auto awaited = Elements(wire.awaited);
  message.awaited.assign(awaited.begin(), awaited.end());
  Status problem = StateFromWire(wire.state, wire.whole, message.state);
  if (problem.ok()) problem = EventsFromWire(wire, message.state.robots.size(), message.events);
  if (problem.ok()) problem = CommandsFromWire(wire, message.state.robots.size(), message.commands);
  if (!problem.ok()) message = {};  // changes since it would have no base
  return problem;
}

void ToWire(const std::vector<HistoryEntry>& entries, dds_sequence_troupe_wire_HistoryEntry& wire, WireArena& arena) {
  troupe_wire_HistoryEntry* out = arena.Fill(wire, entries.size());
  const HistoryEntry* before = nullptr;
  for (const HistoryEntry& entry : entries) {
    out->frame = ToWire(entry.frame, BaseOf(entry, before), arena);
    out->step_follows = entry.step_follows;
    if (entry.world) *arena.Fill(out->world, 1) = ToWire(*entry.world, arena);
    before = &entry;
    ++out;
  }
}

Result<std::vector<HistoryEntry>> FromWire(const dds_sequence_troupe_wire_HistoryEntry& wire) {
  std::vector<HistoryEntry> entries;
  FrameMessage frame;
  for (const troupe_wire_HistoryEntry& from : Elements(wire)) {
    if (!CanRead(from.frame, frame)) return Error{{}, "history with a frame of changes that does not follow"};
    if (Status malformed = FromWire(from.frame, frame); !malformed.ok()) return malformed.error();
    HistoryEntry& entry = entries.emplace_back();
    entry.frame = frame;
    entry.step_follows = from.step_follows;
    const auto worlds = Elements(from.world);
    if (worlds.size() > 1) return Error{{}, "history with several worlds of one state"};
    if (worlds.empty()) continue;
    Result<WorldDescription> world = FromWire(worlds[0]);
    if (!world.ok()) return world.error();
    entry.world = std::move(world).value();
  }
  if (entries.empty()) return Error{{}, "history without a state"};
  return entries;
}

troupe_wire_History ToWire(const HistoryMessage& message, WireArena& arena) {
  return WriteStruct<troupe_wire_History>(message, arena);
}

Result<HistoryMessage> FromWire(const troupe_wire_History& wire) {
  return ReadStruct<HistoryMessage>(wire);
}

}  // namespace troupe::dds
