// The table of controllers says what the controllers read: names, kinds and limits of all parameters.
#include "robot-agent/controller/controller_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robot-agent/controller/create_controller.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

// The parameters that the controller cannot do without, as the table's examples.
Json NeededOf(const ControllerHelp& controller) {
  Json needed = Json::object();
  for (const ParameterHelp& row : controller.parameters) {
    if (row.needed) needed[std::string(row.name)] = Json::parse(row.initial);
  }
  return needed;
}

Status Check(const ControllerHelp& controller, const Json& parameters) {
  return CheckController(std::string(controller.name), parameters.dump());
}

TEST(ControllerTable, HasEveryControllerOnce) {
  std::vector<std::string> names;
  for (const ControllerHelp& controller : ControllerTable()) names.emplace_back(controller.name);
  EXPECT_EQ(names, BuiltInControllers());
}

TEST(ControllerTable, NamesTheParametersThatControllersRead) {
  for (const ControllerHelp& controller : ControllerTable()) {
    std::vector<std::string> names;
    for (const ParameterHelp& row : controller.parameters) names.emplace_back(row.name);
    std::sort(names.begin(), names.end());
    std::string expected;
    for (const std::string& name : names) expected += (expected.empty() ? "expected one of " : ", ") + name;
    if (names.empty()) expected = "expected none";
    Json parameters = NeededOf(controller);
    parameters["0"] = 1;
    const Status status = Check(controller, parameters);
    ASSERT_FALSE(status.ok()) << controller.name;
    EXPECT_TRUE(status.error().message.ends_with(expected)) << status.error().message << " but " << expected;
  }
}

TEST(ControllerTable, HasTheLimitsAndDefaultsThatControllersAccept) {
  for (const ControllerHelp& controller : ControllerTable()) {
    const auto accepts = [&](const ParameterHelp& row, const Json& value) {
      Json parameters = NeededOf(controller);
      parameters[std::string(row.name)] = value;
      if (row.name == "period") parameters["repeat"] = true;        // has no effect without it
      if (row.name == "charge_below") parameters["charge_to"] = 1;  // is not below it
      if (row.name == "charge_to") parameters["charge_below"] = 0;
      if (row.name == "delay_min") parameters["delay_max"] = 1e6;  // is not below it
      if (row.name == "delay_max") parameters["delay_min"] = 0;
      return Check(controller, parameters).ok();
    };
    // The number of a graph is a whole one.
    const auto number = [](const ParameterHelp& row, double value) {
      return row.name == "graph" ? Json(static_cast<std::int64_t>(value)) : Json(value);
    };
    for (const ParameterHelp& row : controller.parameters) {
      const std::string place = std::string(controller.name) + " " + std::string(row.name);
      EXPECT_FALSE(row.help.empty()) << place;
      if (!row.initial.empty()) {
        EXPECT_TRUE(accepts(row, Json::parse(row.initial))) << place;
      }
      if (row.form != "number") continue;
      EXPECT_FALSE(accepts(row, "text")) << place;
      // Maps have a limit of their own for the number of cells.
      if (row.name == "map_size" || row.name == "cell" || row.name == "period") continue;
      EXPECT_TRUE(accepts(row, number(row, row.least))) << place;
      EXPECT_FALSE(accepts(row, row.least - 0.001 * std::max(1.0, std::abs(row.least)))) << place;
      if (!std::isfinite(row.most)) continue;
      EXPECT_TRUE(accepts(row, number(row, row.most))) << place;
      EXPECT_FALSE(accepts(row, row.most + 0.001 * row.most)) << place;
    }
  }
}

}  // namespace
}  // namespace troupe
