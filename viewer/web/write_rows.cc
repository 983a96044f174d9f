// Writes the TypeScript of the rows of a state, as viewer/gateway/page_messages.cc sends them, from the fields of their
// types, and the names of the built-in controllers:
// - write_rows OUTPUT.ts
//
// Run by the build, so that a field added to a row type reaches the page without a line of TypeScript, and a mismatch
// of types on the two sides is a compiler's error.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

#include "robot-agent/controller/create_controller.h"
#include "troupe/event.h"
#include "troupe/world_state.h"
#include "viewer/gateway/page_messages.h"

namespace troupe {
namespace {

// "charge_watts": chargeWatts, or ChargeWatts.
std::string Camel(std::string_view name, bool starts_upper) {
  std::string text;
  bool is_upper = starts_upper;
  for (const char c : name) {
    if (c != '_') text += is_upper ? static_cast<char>(c - 'a' + 'A') : c;
    is_upper = c == '_';
  }
  return text;
}

// "robots": RobotRow.
std::string RowName(std::string_view table) {
  if (table == "people") return "PersonRow";
  return Camel(table.substr(0, table.size() - 1), true) + "Row";
}

template <typename Visit>
void ForEachTableOnPage(const Visit& visit) {
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    if constexpr (kIsOnPage<Row>) visit(table, std::string(table.name), RowName(table.name));
  });
}

void WriteRows(std::ostream& out) {
  out << "// Made by viewer/web/write_rows.cc from troupe/world_state.h, which has the units, and troupe/event.h.\n"
         "import type {Pose, Reader, Twist} from '../src/protocol';\n";
  ForEachTableOnPage([&]<typename Row>(const Field<WorldState, std::vector<Row>>&, const auto&, const auto& row) {
    out << "\nexport interface " << row << " {\n";
    ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
      out << "  " << Camel(field.name, false) << ": " << PageValue<Part>::kType.type << ";\n";
    });
    out << "}\n";
  });
  out << "\n// The rows of an update, by their numbers.\nexport interface StateRows {\n";
  ForEachTableOnPage([&](const auto&, const auto& table, const auto& row) {
    out << "  " << table << ": Array<[number, " << row << "]>;\n";
  });
  out << "}\n\nexport function readStateRows(r: Reader): StateRows {\n  return {\n";
  ForEachTableOnPage([&]<typename Row>(const Field<WorldState, std::vector<Row>>&, const auto& table, const auto& row) {
    out << "    " << table << ": r.list((): [number, " << row << "] => [r.u32(), {\n";
    ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
      out << "      " << Camel(field.name, false) << ": " << PageValue<Part>::kType.read << ",\n";
    });
    out << "    }]),\n";
  });
  out << "  };\n}\n\n// The state, as updates add up.\nexport class StateTables {\n";
  ForEachTableOnPage(
      [&](const auto&, const auto& table, const auto& row) { out << "  " << table << ": " << row << "[] = [];\n"; });
  out << "\n  applyRows(rows: StateRows): void {\n";
  ForEachTableOnPage([&](const auto&, const auto& table, const auto&) {
    out << "    for (const [i, row] of rows." << table << ") this." << table << "[i] = row;\n";
  });
  out << "  }\n}\n\nexport const enum EventType {\n";
  for (int type = 0; type <= static_cast<int>(LastOf(EventType())); ++type) {
    out << "  " << Camel(ToString(static_cast<EventType>(type)), true) << ",\n";
  }
  out << "}\n\n// Of robot-agent/controller, sorted.\nexport const BUILT_IN_CONTROLLERS = [\n";
  for (const std::string& name : BuiltInControllers()) out << "  '" << name << "',\n";
  out << "];\n";
}

}  // namespace
}  // namespace troupe

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "error: found no argument, expected the path of the output\n";
    return EXIT_FAILURE;
  }
  std::ofstream out(arguments[1]);
  troupe::WriteRows(out);
  return out.flush().good() ? EXIT_SUCCESS : EXIT_FAILURE;
}
