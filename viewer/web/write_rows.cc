// Writes the TypeScript of the rows of a state, of the description of a world and of the readings of sensors, as
// viewer/gateway/page_values.h sends them, from the fields of their types, and the names of the built-in controllers:
// - write_rows OUTPUT.ts
//
// Run by the build, so that a new field reaches the page without a line of TypeScript, and a mismatch of types on the
// two sides is a compiler's error.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

#include "robot-agent/controller/create_controller.h"
#include "troupe/event.h"
#include "troupe/world_state.h"
#include "viewer/gateway/page_layout.h"
#include "viewer/gateway/page_messages.h"
#include "viewer/gateway/page_values.h"

namespace troupe {
namespace {

// "robots": RobotRow.
std::string RowName(std::string_view table) {
  if (table == "people") return "PersonRow";
  if (table == "coverage") return "CoverageRow";
  return CamelCase(table.substr(0, table.size() - 1), true) + "Row";
}

template <typename Visit>
void ForEachTableOnPage(const Visit& visit) {
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    if constexpr (kIsShownTable<Row>) visit(table, std::string(table.name), RowName(table.name));
  });
}

void WriteRows(std::ostream& out) {
  out << "// Made by viewer/web/write_rows.cc from the fields of troupe/world_state.h, world_description.h, sensor.h, "
         "which\n"
         "// have the units, and troupe/event.h.\n"
         "import type {Color, Pose, Reader, Shape, Twist} from '../src/protocol';\n\n"
         "export const LAYOUT = "
      << PageLayout() << ";\n\n";
  ForEachTableOnPage([&]<typename Row>(const Field<WorldState, std::vector<Row>>&, const auto&, const auto& row) {
    out << "export type " << row << " = " << PageValue<Row>::Type() << ";\n";
  });
  out << "\nexport type WorldDescription = " << PageValue<WorldDescription>::Type()
      << ";\n\nexport function readDescription(r: Reader): WorldDescription {\n  return "
      << PageValue<WorldDescription>::Read()
      << ";\n}\n\n// Of a sensor.\nexport type Content = " << PageValue<ReadingContent>::Type()
      << ";\n\nexport function readContent(r: Reader): Content {\n  return " << PageValue<ReadingContent>::Read()
      << ";\n}\n";
  out << "\n// The rows of an update, by their numbers.\nexport interface StateRows {\n";
  ForEachTableOnPage([&](const auto&, const auto& table, const auto& row) {
    out << "  " << table << ": Array<[number, " << row << "]>;\n";
  });
  out << "}\n\nexport function readStateRows(r: Reader): StateRows {\n  return {\n";
  ForEachTableOnPage([&]<typename Row>(const Field<WorldState, std::vector<Row>>&, const auto& table, const auto& row) {
    out << "    " << table << ": r.list((): [number, " << row << "] => [r.u32(), " << PageValue<Row>::Read() << "]),\n";
  });
  out << "  };\n}\n\n// The state, as updates add up.\nexport class StateTables {\n";
  ForEachTableOnPage(
      [&](const auto&, const auto& table, const auto& row) { out << "  " << table << ": " << row << "[] = [];\n"; });
  out << "\n  applyRows(rows: StateRows): void {\n";
  ForEachTableOnPage([&](const auto&, const auto& table, const auto&) {
    out << "    for (const [i, row] of rows." << table << ") this." << table << "[i] = row;\n";
  });
  out << "  }\n}\n\nexport const enum EventType {\n";
  for (const char* const name : NamesOf(EventType())) out << "  " << CamelCase(name, true) << ",\n";
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
