// The table of properties, of which forms and help texts are made, against the readers of files and the documentation.
#include "worldfile/models/types/property_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>

#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/worldfile/world_folder.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// A world in which a model of the row's type has the property; empty for types with other required parts.
std::string WorldWith(const PropertyHelp& row) {
  static const std::set<std::string> on_robots = {"ranger", "fiducial", "bumper",       "blobfinder", "camera",
                                                  "radio",  "imu",      "blinkenlight", "actuator"};
  const std::string property = row.name + " " + (row.initial.empty() ? "1" : row.initial) + " ";
  if (row.type == "world") return property + "\nposition( )";
  if (row.type == "*") return "position( " + property + ")";
  if (row.type == "sensor") return "position( ranger( sensor( " + property + ") ) )";
  if (row.type == "lift" || row.type == "gripper") return {};
  return on_robots.contains(row.type) ? "position( " + row.type + "( " + property + ") )"
                                      : row.type + "( " + property + ")";
}

TEST(PropertyTable, EachNumberAndFlagIsReadAndItsDefaultIsAValue) {
  const WorldFolder folder;
  int count = 0;
  for (const PropertyHelp& row : PropertyTable()) {
    const std::string world = WorldWith(row);
    if ((row.form != "number" && row.form != "flag") || world.empty()) continue;
    ++count;
    for (const std::string& warning : folder.WarningsOf(world)) {
      EXPECT_EQ(warning.find("has no effect"), std::string::npos) << warning;
      EXPECT_EQ(warning.find("'" + row.name + "', expected"), std::string::npos) << warning;
    }
  }
  EXPECT_GT(count, 60);
}

TEST(PropertyTable, EachRowHasAHelpAndIsOneOfItsType) {
  std::set<std::string> names;
  for (const PropertyHelp& row : PropertyTable()) {
    EXPECT_TRUE(names.insert(row.type + "." + row.name).second) << row.name;
    EXPECT_FALSE(row.help.empty()) << row.type << "." << row.name;
  }
}

TEST(PropertyTable, FieldsOfDescriptionsAreProperties) {
  const auto find = [](const std::string& type, const std::string& name) {
    const auto is_it = [&](const PropertyHelp& row) { return row.type == type && row.name == name; };
    const auto found = std::find_if(PropertyTable().begin(), PropertyTable().end(), is_it);
    return found == PropertyTable().end() ? PropertyHelp{} : *found;
  };
  const PropertyHelp seconds = find("door", "seconds");
  EXPECT_EQ(seconds.form + "," + seconds.unit + "," + seconds.initial, "number,s,3");
  const PropertyHelp opening = find("door", "opening");
  EXPECT_EQ(opening.unit + "," + opening.initial, "0 to 1,0");
  EXPECT_EQ(find("door", "operated").form + "," + find("door", "operated").initial, "flag,1");
  EXPECT_EQ(find("imu", "gyro_noise").unit, "deg/s");
  EXPECT_EQ(find("radio", "bandwidth").initial, "10000");
}

// Each stands in a row of a table of the pages.
TEST(PropertyTable, EachRowIsInTheDocumentation) {
  const char* const source = std::getenv("TROUPE_SOURCE_DIR");
  if (source == nullptr) GTEST_SKIP() << "TROUPE_SOURCE_DIR is not set";
  const std::string docs = std::string(source) + "/docs/";
  const std::string pages = test::ValueOf(ReadTextFile(docs + "world-files.md", {"world-files.md", 0, 0})) + "\n" +
                            test::ValueOf(ReadTextFile(docs + "sensors.md", {"sensors.md", 0, 0}));
  std::set<std::string> in_tables;
  for (std::size_t at = pages.find("\n| `"); at != std::string::npos; at = pages.find("\n| `", at + 1)) {
    const std::string cell = pages.substr(at + 3, pages.find(" | ", at + 3) - at - 3);
    for (std::size_t name = cell.find('`'); name != std::string::npos;
         name = cell.find('`', cell.find('`', name + 1) + 1)) {
      in_tables.insert(cell.substr(name + 1, cell.find_first_of("` [", name + 1) - name - 1));
    }
  }
  for (const PropertyHelp& row : PropertyTable()) {
    EXPECT_TRUE(in_tables.contains(row.name)) << row.type << "." << row.name << " is in no table of docs";
  }
}

}  // namespace
}  // namespace troupe
