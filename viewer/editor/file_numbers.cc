#include "viewer/editor/file_numbers.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "worldfile/edit/text_change.h"

namespace troupe {
namespace {

WrittenNumber ChangedNumber(const Value::Number* old, double number, double change, int decimals) {
  const bool is_same = old != nullptr && std::abs(change) < 0.5 * std::pow(10.0, -decimals);
  return {is_same ? old->text : PlainNumber(number, decimals)};
}

}  // namespace

double WrappedDegrees(double degrees) {
  degrees = std::remainder(degrees, 360.0);
  return degrees <= -180.0 ? degrees + 360.0 : degrees;
}

std::vector<Value::Number> NumbersOf(const WorldNode& node, const std::string& name) {
  std::vector<Value::Number> numbers;
  const Property* const property = node.Find(name);
  const auto* const tuple =
      property != nullptr ? std::get_if<std::vector<Value::Scalar>>(&property->value.content) : nullptr;
  for (std::size_t i = 0; tuple != nullptr && i < tuple->size(); ++i) {
    const auto* const number = std::get_if<Value::Number>(&(*tuple)[i]);
    numbers.push_back(number != nullptr ? *number : Value::Number{0.0, "0"});
  }
  return numbers;
}

WrittenValue ChangedTuple(const std::vector<Value::Number>& old, const std::vector<double>& numbers, int decimals) {
  std::vector<WrittenScalar> tuple;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Value::Number* const before = i < old.size() ? &old[i] : nullptr;
    const double change = before != nullptr ? numbers[i] - before->value : 0.0;
    tuple.emplace_back(ChangedNumber(before, numbers[i], change, decimals));
  }
  return {std::move(tuple)};
}

WrittenValue ChangedPose(std::vector<Value::Number> old, const Pose& pose, const FileUnits& units) {
  old.resize(4, Value::Number{0.0, "0"});
  const bool in_radians = units.radians == 1.0;
  const double turn = in_radians ? 2.0 * std::numbers::pi : 360.0;
  const double heading = in_radians ? pose.heading : WrappedDegrees(AngleInFile(pose.heading, units));
  std::vector<WrittenScalar> tuple;
  const double lengths[] = {pose.x / units.metres, pose.y / units.metres, pose.z / units.metres};
  for (std::size_t i = 0; i < 3; ++i) {
    tuple.emplace_back(ChangedNumber(&old[i], lengths[i], lengths[i] - old[i].value, kLengthDecimals));
  }
  const double change = std::remainder(heading - old[3].value, turn);
  tuple.emplace_back(ChangedNumber(&old[3], heading, change, AngleDecimals(units)));
  return {std::move(tuple)};
}

double AngleInFile(double angle, const FileUnits& units) {
  return angle / units.radians;
}

int AngleDecimals(const FileUnits& units) {
  return units.radians == 1.0 ? kRadianDecimals : kHeadingDecimals;
}

}  // namespace troupe
