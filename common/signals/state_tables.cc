#include "common/signals/state_tables.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "common/base/json_writer.h"
#include "common/model/states.h"
#include "troupe/check.h"

namespace troupe {
namespace {

template <typename Value>
concept IsId = requires(const Value& value) {
  { value.index() } -> std::convertible_to<std::size_t>;
};

// The value of a field as a number and as a text.
template <typename Value>
struct Cell {
  static_assert(std::is_arithmetic_v<Value> || std::is_enum_v<Value> || IsId<Value>,
                "a field of another type needs a Cell");
  static constexpr ValueType kType = std::is_same_v<Value, bool>   ? ValueType::kTruth
                                     : std::is_arithmetic_v<Value> ? ValueType::kNumber
                                                                   : ValueType::kText;
  static double Number(const Value& value) {
    if constexpr (IsId<Value>) {
      return static_cast<double>(value.index());
    } else {
      return static_cast<double>(value);
    }
  }
  static std::string Text(const WorldDescription& world, const Value& value) {
    if constexpr (std::is_enum_v<Value>) return NameOf(value);
    if constexpr (IsId<Value>) return TextOf(world, value);
    return {};
  }
};
template <typename Value>
struct Cell<std::optional<Value>> {
  static constexpr ValueType kType = Cell<Value>::kType;
  static double Number(const std::optional<Value>& value) { return value ? Cell<Value>::Number(*value) : kNoNumber; }
  static std::string Text(const WorldDescription& world, const std::optional<Value>& value) {
    return value ? Cell<Value>::Text(world, *value) : std::string();
  }
};
// Bytes: their number, and two digits for each.
template <>
struct Cell<std::vector<std::uint8_t>> {
  static constexpr ValueType kType = ValueType::kText;
  static double Number(const std::vector<std::uint8_t>& bytes) { return static_cast<double>(bytes.size()); }
  static std::string Text(const WorldDescription&, const std::vector<std::uint8_t>& bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes) {
      text += kDigits[byte >> 4U];
      text += kDigits[byte & 15U];
    }
    return text;
  }
};

std::string SingularOf(std::string_view table) {
  if (table == "people") return "person";
  return std::string(table.ends_with('s') ? table.substr(0, table.size() - 1) : table);
}

template <typename Row>
constexpr bool kIsOfRobots = std::is_same_v<Row, JointState> || std::is_same_v<Row, GripperState> ||
                             std::is_same_v<Row, ImuState> || std::is_same_v<Row, CameraState>;

template <typename Row>
StateTable MakeTable(const Field<WorldState, std::vector<Row>>& table) {
  StateTable made{std::string(table.name), SingularOf(table.name), kIsVaryingTable<Row>, kIsOfRobots<Row>, {}, nullptr};
  ForEachLeaf<Row>([&]<typename Leaf>(const Leaf& leaf) {
    using Value = typename Leaf::Part;
    Signal signal{std::string(leaf.name), std::string(leaf.unit), std::string(leaf.documentation), Cell<Value>::kType,
                  [table, leaf](const SignalView& view, std::size_t row) {
                    return Cell<Value>::Number(leaf.Of(table.Of(view.state)[row]));
                  }};
    if (signal.type == ValueType::kText) {
      signal.text = [table, leaf](const SignalView& view, std::size_t row) {
        return Cell<Value>::Text(view.world, leaf.Of(table.Of(view.state)[row]));
      };
    }
    if constexpr (std::is_enum_v<Value>) {
      signal.possible = [](const WorldDescription&) { return AllNames<Value>(); };
    }
    made.signals.push_back(std::move(signal));
  });
  return made;
}

std::vector<StateTable> MakeTables() {
  std::vector<StateTable> tables;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    tables.push_back(MakeTable<Row>(table));
    AddDerivedSignals(tables.back());
  });
  return tables;
}

// The names of the rows of a table: an overload for each type with names of its own.
using Names = std::vector<ThingName>;

template <typename Parts>
Names NamesOfModels(const WorldDescription& world, const Parts& parts) {
  Names names;
  for (const auto& part : parts) {
    ModelId model;
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(part)>, ModelId>) {
      model = part;
    } else if constexpr (requires { part.root; }) {
      model = part.root;
    } else {
      model = part.model;
    }
    names.push_back({world.model(model).name, model});
  }
  return names;
}
template <typename Parts>
Names NamesOfParts(const WorldDescription& world, const Parts& parts) {
  Names names;
  for (const auto& part : parts) {
    names.push_back({world.robot(part.robot).name + "." + part.name, part.model, part.robot});
  }
  return names;
}
Names NamesOfSensors(const WorldDescription& world, const std::vector<SensorPlace>& places) {
  Names names;
  for (const SensorPlace& place : places) {
    const RobotDescription& robot = world.robot(place.robot);
    names.push_back({robot.name + "." + robot.sensors[place.sensor].name, robot.root, place.robot});
  }
  return names;
}

Names NamesOf(const WorldDescription& world, const std::vector<RobotState>&) {
  return NamesOfModels(world, world.robots);
}
Names NamesOf(const WorldDescription& world, const std::vector<JointState>&) {
  return NamesOfParts(world, world.joints);
}
Names NamesOf(const WorldDescription& world, const std::vector<GripperState>&) {
  return NamesOfParts(world, world.grippers);
}
Names NamesOf(const WorldDescription& world, const std::vector<ObjectState>&) {
  return NamesOfModels(world, world.objects);
}
Names NamesOf(const WorldDescription& world, const std::vector<StoreState>&) {
  return NamesOfModels(world, FindStores(world));
}
Names NamesOf(const WorldDescription& world, const std::vector<ImuState>&) {
  return NamesOfSensors(world, FindImus(world));
}
Names NamesOf(const WorldDescription& world, const std::vector<LightState>&) {
  return NamesOfModels(world, FindLights(world));
}
Names NamesOf(const WorldDescription& world, const std::vector<CameraState>&) {
  return NamesOfSensors(world, FindCameras(world));
}
Names NamesOf(const WorldDescription& world, const std::vector<DoorState>&) {
  return NamesOfModels(world, world.doors);
}
Names NamesOf(const WorldDescription& world, const std::vector<LiftState>&) {
  return NamesOfModels(world, world.lifts);
}
Names NamesOf(const WorldDescription& world, const std::vector<PersonState>&) {
  return NamesOfModels(world, world.people);
}

Names NamesOf(const WorldDescription& world, const std::vector<ZoneState>&) {
  Names names;
  for (const ZoneDescription& zone : world.zones) names.push_back({zone.name});
  return names;
}
Names NamesOf(const WorldDescription& world, const std::vector<FlowState>&) {
  Names names;
  for (const GoodsFlow& flow : world.flows) names.push_back({flow.name});
  return names;
}

Names NamesOf(const WorldDescription& world, const std::vector<VisitorState>&) {
  Names names;
  for (const VisitorDescription& visitor : world.visitors) {
    const ModelId root = world.person(visitor.person).root;
    names.push_back({world.model(root).name, root});
  }
  return names;
}
Names NamesOf(const WorldDescription& world, const std::vector<VisitorFlowState>&) {
  Names names;
  for (const VisitorFlow& flow : world.visitor_flows) names.push_back({flow.name});
  return names;
}

bool HasValue(const Signal& signal, const SignalView& view, std::size_t row) {
  if (signal.type == ValueType::kText) return !signal.text(view, row).empty();
  return !std::isnan(signal.number(view, row));
}

}  // namespace

void StateTable::Add(Signal signal) {
  const auto same =
      std::find_if(signals.begin(), signals.end(), [&](const Signal& s) { return s.name == signal.name; });
  if (same != signals.end()) {
    *same = std::move(signal);
  } else {
    signals.push_back(std::move(signal));
  }
}

const Signal* StateTable::Find(std::string_view signal) const {
  const auto found = std::find_if(signals.begin(), signals.end(), [&](const Signal& s) { return s.name == signal; });
  return found == signals.end() ? nullptr : &*found;
}

std::span<const StateTable> StateTables() {
  static const std::vector<StateTable> kTables = [] {
    std::vector<StateTable> tables = MakeTables();
    std::size_t number = 0;
    ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>&) {
      tables[number++].rows = [](const WorldDescription&, const WorldState& state) {
        std::size_t rows = 0;
        ForEachTable([&]<typename Other>(const Field<WorldState, std::vector<Other>>& table) {
          if constexpr (std::is_same_v<Row, Other>) rows = table.Of(state).size();
        });
        return rows;
      };
    });
    for (StateTable& table : MakeDescriptionTables()) tables.push_back(std::move(table));
    return tables;
  }();
  return kTables;
}

std::size_t KindOf(std::string_view table) {
  const std::span<const StateTable> tables = StateTables();
  const auto found = std::find_if(tables.begin(), tables.end(), [&](const StateTable& t) { return t.name == table; });
  TROUPE_CHECK(found != tables.end());
  return static_cast<std::size_t>(found - tables.begin());
}

std::size_t ObjectKind() {
  static const std::size_t kKind = KindOf("objects");
  return kKind;
}

std::size_t PersonKind() {
  static const std::size_t kKind = KindOf("people");
  return kKind;
}

std::vector<std::vector<ThingName>> NameThings(const WorldDescription& world) {
  std::vector<Names> names;
  const WorldState placed = PlacedState(world);
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    Names& its = names.emplace_back();
    if constexpr (requires { NamesOf(world, table.Of(placed)); }) {
      its = NamesOf(world, table.Of(placed));
    } else if constexpr (!kIsVaryingTable<Row>) {
      for (std::size_t i = 0; i < table.Of(placed).size(); ++i) {
        its.push_back({SingularOf(table.name) + " " + std::to_string(i)});
      }
    }
  });
  for (Names& its : NameDescribedThings(world)) names.push_back(std::move(its));
  return names;
}

void WriteCell(const Signal& signal, const SignalView& view, std::size_t row, JsonWriter& json) {
  if (signal.type == ValueType::kText) {
    const std::string text = signal.text(view, row);
    text.empty() ? json.Null() : json.Value(text);
  } else if (signal.type == ValueType::kTruth) {
    json.Value(signal.number(view, row) != 0.0 ? 1 : 0);
  } else {
    json.Value(signal.number(view, row));
  }
}

void WriteRow(const StateTable& table, const SignalView& view, std::size_t row, JsonWriter& json) {
  json.BeginObject();
  if (!table.varies) {
    json.Member("name", view.things.name(view.things.first(KindOf(table.name)) + static_cast<ThingId>(row)));
  }
  for (const Signal& signal : table.signals) {
    if (!HasValue(signal, view, row)) continue;
    json.Key(signal.name);
    WriteCell(signal, view, row, json);
  }
  json.EndObject();
}

void WriteRows(const StateTable& table, const SignalView& view, JsonWriter& json) {
  const std::size_t kind = KindOf(table.name);
  json.BeginList();
  for (std::size_t row = 0; row < table.rows(view.world, view.state); ++row) {
    const ThingId thing = view.things.first(kind) + static_cast<ThingId>(row);
    if (!table.varies && !view.things.exists(thing)) continue;
    WriteRow(table, view, row, json);
  }
  json.EndList();
}

std::string TextOf(const WorldDescription& world, ModelId model) {
  return world.model(model).name;
}
std::string TextOf(const WorldDescription& world, RobotId robot) {
  return world.robot(robot).name;
}
std::string TextOf(const WorldDescription& world, ObjectId object) {
  return world.model(world.objects[object.index()]).name;
}
std::string TextOf(const WorldDescription& world, PersonId person) {
  return world.model(world.person(person).root).name;
}
std::string TextOf(const WorldDescription& world, JointId joint) {
  return world.robot(world.joint(joint).robot).name + "." + world.joint(joint).name;
}
std::string TextOf(const WorldDescription& world, GripperId gripper) {
  return world.robot(world.gripper(gripper).robot).name + "." + world.gripper(gripper).name;
}

}  // namespace troupe
