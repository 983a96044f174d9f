// The tables of a state with their signals, from the fields of their rows: a new table or field of the state is a
// table or signal here, and so in expectations, exported tables, plots and Python.
//
// The tables are made once in a process, from the lists of fields at compile time, and never change; any thread reads
// them. A signal's name is part of the language of expectations and of exported files: renaming a field renames it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/signals/signal.h"
#include "common/signals/things.h"

namespace troupe {

// One kind of things.
struct StateTable {
  std::string name;      // of the member of WorldState: "doors"
  std::string singular;  // "door"
  bool varies = false;   // its rows come and go: they are no things
  std::vector<Signal> signals;
  std::size_t (*rows)(const WorldState& state) = nullptr;

  const Signal* Find(std::string_view signal) const;  // null: it has none of that name
};

// In the order of WorldState. Constant.
std::span<const StateTable> StateTables();
// The place of a table, by its name. REQUIRES: it exists
std::size_t KindOf(std::string_view table);
inline std::size_t RobotKind() {
  return 0;
}
std::size_t ObjectKind();
std::size_t PersonKind();

// The model of the row of a table and its name.
struct ThingName {
  std::string name;
  std::optional<ModelId> model = {};
};
// The names of the rows of the state's tables, by table. Those of a table that varies: none.
std::vector<std::vector<ThingName>> NameThings(const WorldDescription& world);

// The texts of cells: names of models and their parts; empty for none.
std::string TextOf(const WorldDescription& world, ModelId model);
std::string TextOf(const WorldDescription& world, RobotId robot);
std::string TextOf(const WorldDescription& world, ObjectId object);
std::string TextOf(const WorldDescription& world, PersonId person);
std::string TextOf(const WorldDescription& world, JointId joint);
std::string TextOf(const WorldDescription& world, GripperId gripper);

// Adds what follows from the fields of a row. One of the name of a field replaces it.
void AddDerivedSignals(StateTable& table);

}  // namespace troupe
