#include "viewer/gateway/page_robot_command.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostOrders = 64;

Error Malformed(const char* expected) {
  return {{}, std::string("found a malformed command of a robot, expected ") + expected};
}

std::optional<double> Number(const Json& value) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) return std::nullopt;
  return value.get<double>();
}

template <std::size_t kCount>
std::optional<std::array<double, kCount>> Numbers(const Json& value) {
  if (!value.is_array() || value.size() != kCount) return std::nullopt;
  std::array<double, kCount> numbers{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::optional<double> number = Number(value[i]);
    if (!number) return std::nullopt;
    numbers[i] = *number;
  }
  return numbers;
}

// False if there is a member of that name that is not a number.
bool ReadOptional(const Json& object, const char* key, std::optional<double>& value) {
  const auto member = object.find(key);
  if (member == object.end()) return true;
  value = Number(*member);
  return value.has_value();
}

Result<std::vector<GripperOrder>> ParseOrders(const Json& value) {
  if (!value.is_array() || value.size() > kMostOrders) return Malformed("a list of grippers");
  std::vector<GripperOrder> orders;
  for (const Json& element : value) {
    const auto number = element.is_object() ? element.find("gripper") : element.end();
    if (!element.is_object() || number == element.end() || !number->is_number_unsigned()) {
      return Malformed("the number of a gripper");
    }
    GripperOrder& order = orders.emplace_back();
    order.gripper = number->get<std::size_t>();
    if (!ReadOptional(element, "opening", order.opening) || !ReadOptional(element, "lift", order.lift)) {
      return Malformed("percentages of a gripper");
    }
  }
  return orders;
}

Result<Goal> ParseGoal(const Json& value) {
  Goal goal;
  const auto waypoints = value.is_object() ? value.find("waypoints") : value.end();
  if (!value.is_object() || waypoints == value.end() || !waypoints->is_array()) return Malformed("waypoints");
  for (const Json& waypoint : *waypoints) {
    const auto point = Numbers<2>(waypoint);
    if (!point) return Malformed("two coordinates of a waypoint");
    goal.waypoints.emplace_back((*point)[0], (*point)[1]);
  }
  if (!ReadOptional(value, "heading", goal.heading)) return Malformed("the heading of a goal");
  return goal;
}

}  // namespace

Result<RobotCommand> ParsePageRobotCommand(const Json& object) {
  RobotCommand command;
  if (const auto twist = object.find("twist"); twist != object.end()) {
    const auto numbers = Numbers<3>(*twist);
    if (!numbers) return Malformed("three numbers of a twist");
    command.twist = Twist{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  }
  if (const auto grippers = object.find("grippers"); grippers != object.end()) {
    Result<std::vector<GripperOrder>> orders = ParseOrders(*grippers);
    if (!orders.ok()) return orders.error();
    command.grippers = std::move(orders).value();
  }
  if (const auto member = object.find("goal"); member != object.end()) {
    Result<Goal> goal = ParseGoal(*member);
    if (!goal.ok()) return goal.error();
    command.goal = std::move(goal).value();
  }
  if (!command.twist && command.grippers.empty() && !command.goal) return Malformed("a twist, grippers or a goal");
  return command;
}

}  // namespace troupe
