// The tables of things with their signals. The tables of a state are made from the fields of their rows: a new table or
// field of the state is a table or signal here, and so in expectations, exported tables, plots and Python. Behind them
// are the tables of things that only the description has (description_tables.cc): levels, lanes and sensors.
//
// The tables are made once in a process, from the lists of fields at compile time, and never change; any thread reads
// them. A signal's name is part of the language of expectations and of exported files: renaming a field renames it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/signals/signal.h"
#include "common/signals/things.h"

namespace troupe {

class JsonWriter;

// One kind of things.
struct StateTable {
  std::string name;        // "doors": of the member of WorldState, or of the description
  std::string singular;    // "door"
  bool varies = false;     // its rows come and go: they are no things
  bool of_robots = false;  // its things are parts of robots: "ROBOT.PART"
  std::vector<Signal> signals = {};
  std::size_t (*rows)(const WorldDescription& world, const WorldState& state) = nullptr;

  const Signal* Find(std::string_view signal) const;  // null: it has none of that name
  // Adds a signal. It replaces one of the same name: what follows from the fields of a row may replace a field.
  void Add(Signal signal);
  // `number(view, row)` and `truth(view, row)` are the signal's value of a row.
  template <typename Number>
  void AddNumber(const char* signal, const char* unit, const char* documentation, Number number) {
    Add({signal, unit, documentation, ValueType::kNumber, std::move(number)});
  }
  template <typename Truth>
  void AddTruth(const char* signal, const char* documentation, Truth truth) {
    Add({signal, "", documentation, ValueType::kTruth,
         [truth](const SignalView& view, std::size_t row) { return truth(view, row) ? 1.0 : 0.0; }});
  }
};

// In the order of WorldState, then those of the description. Constant.
std::span<const StateTable> StateTables();
// The place of a table, by its name. REQUIRES: it exists
std::size_t KindOf(std::string_view table);
inline std::size_t RobotKind() {
  return 0;
}
std::size_t ObjectKind();
std::size_t PersonKind();

// What Things knows of a row of a table.
struct ThingName {
  std::string name;
  std::optional<ModelId> model = {};
  std::optional<RobotId> robot = {};  // that it is a part of
};
// The names of the rows of all tables, by table. A table that varies has none.
std::vector<std::vector<ThingName>> NameThings(const WorldDescription& world);

// The value of a signal in JSON: a number, 0 or 1 of a truth, or a text; null if it has none.
void WriteCell(const Signal& signal, const SignalView& view, std::size_t row, JsonWriter& json);
// A row of a table: {"name": "lobby_door", "opening": 0.5, ...}, without the signals that it does not have.
void WriteRow(const StateTable& table, const SignalView& view, std::size_t row, JsonWriter& json);
// The rows of a table: [{"name": "lobby_door", "opening": 0.5, ...}, ...]; things that do not exist are left out,
// and so are signals that a thing does not have: a schema gives each member one type. The rows of a table that varies
// have no name.
void WriteRows(const StateTable& table, const SignalView& view, JsonWriter& json);

// The texts of cells: names of models and their parts; empty for none.
std::string TextOf(const WorldDescription& world, ModelId model);
std::string TextOf(const WorldDescription& world, RobotId robot);
std::string TextOf(const WorldDescription& world, ObjectId object);
std::string TextOf(const WorldDescription& world, PersonId person);
std::string TextOf(const WorldDescription& world, JointId joint);
std::string TextOf(const WorldDescription& world, GripperId gripper);

// Adds the signals that follow from the fields of a row.
void AddDerivedSignals(StateTable& table);
// Adds those of the waits of robots.
void AddWaitSignals(StateTable& table);

// The tables of what only the description has, and the names of their rows.
std::vector<StateTable> MakeDescriptionTables();
std::vector<std::vector<ThingName>> NameDescribedThings(const WorldDescription& world);
// The place among `levels` of the one that LevelAt names; 0 without levels.
std::size_t LevelNumberAt(std::span<const LevelDescription> levels, double z);

}  // namespace troupe
