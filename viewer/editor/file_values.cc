#include "viewer/editor/file_values.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace troupe {
namespace {

Value::Number ChangedNumber(const Value::Number* old, double number, double change, int decimals) {
  const bool is_same = old != nullptr && std::abs(change) < 0.5 * std::pow(10.0, -decimals);
  return is_same ? *old : RoundedNumber(number, decimals);
}

}  // namespace

double WrappedDegrees(double degrees) {
  degrees = std::remainder(degrees, 360.0);
  return degrees <= -180.0 ? degrees + 360.0 : degrees;
}

std::vector<Value::Number> NumbersOf(const WorldNode& node, const std::string& name) {
  std::vector<Value::Number> numbers;
  const auto* const tuple = node.FindContent<Value::Tuple>(name);
  for (std::size_t i = 0; tuple != nullptr && i < tuple->size(); ++i) {
    const auto* const number = std::get_if<Value::Number>(&(*tuple)[i]);
    numbers.push_back(number != nullptr ? *number : Value::Number{0.0, "0"});
  }
  return numbers;
}

Pose OriginOf(const WorldNode& node, const FileUnits& units) {
  const std::vector<Value::Number> numbers = NumbersOf(node, "origin");
  if (numbers.size() != 4) return {};
  return {numbers[0].value * units.metres, numbers[1].value * units.metres, numbers[2].value * units.metres,
          numbers[3].value * units.radians};
}

Value ChangedTuple(const std::vector<Value::Number>& old, const std::vector<double>& numbers, int decimals) {
  Value::Tuple tuple;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Value::Number* const before = i < old.size() ? &old[i] : nullptr;
    const double change = before != nullptr ? numbers[i] - before->value : 0.0;
    tuple.emplace_back(ChangedNumber(before, numbers[i], change, decimals));
  }
  return {std::move(tuple), {}};
}

Value ChangedPose(std::vector<Value::Number> old, const Pose& pose, const FileUnits& units) {
  old.resize(4, Value::Number{0.0, "0"});
  const bool in_radians = units.radians == 1.0;
  const double turn = in_radians ? 2.0 * std::numbers::pi : 360.0;
  const double heading = in_radians ? pose.heading : WrappedDegrees(AngleInFile(pose.heading, units));
  Value::Tuple tuple;
  const double lengths[] = {pose.x / units.metres, pose.y / units.metres, pose.z / units.metres};
  for (std::size_t i = 0; i < 3; ++i) {
    tuple.emplace_back(ChangedNumber(&old[i], lengths[i], lengths[i] - old[i].value, kLengthDecimals));
  }
  const double change = std::remainder(heading - old[3].value, turn);
  tuple.emplace_back(ChangedNumber(&old[3], heading, change, AngleDecimals(units)));
  return {std::move(tuple), {}};
}

double AngleInFile(double angle, const FileUnits& units) {
  return angle / units.radians;
}

int AngleDecimals(const FileUnits& units) {
  return units.radians == 1.0 ? kRadianDecimals : kHeadingDecimals;
}

std::vector<DrawnBlock> BlocksInFrame(std::vector<DrawnBlock> blocks, const Pose& X_DF, double metres) {
  const Transform2 transform(X_DF);
  for (DrawnBlock& block : blocks) {
    for (Vec2& corner : block.outline) corner = transform.InverseTransform(corner) / metres;
    block.z_min = (block.z_min - X_DF.z) / metres;
    block.z_max = (block.z_max - X_DF.z) / metres;
  }
  return blocks;
}

BlockBounds BoundsOf(const std::vector<DrawnBlock>& blocks) {
  BlockBounds bounds;
  for (const DrawnBlock& block : blocks) {
    for (const Vec2& corner : block.outline) {
      bounds.min_x = std::min(bounds.min_x, corner.x());
      bounds.max_x = std::max(bounds.max_x, corner.x());
      bounds.min_y = std::min(bounds.min_y, corner.y());
      bounds.max_y = std::max(bounds.max_y, corner.y());
    }
    bounds.min_z = std::min(bounds.min_z, block.z_min);
    bounds.max_z = std::max(bounds.max_z, block.z_max);
  }
  return bounds;
}

FittedBody Fitted(const std::vector<DrawnBlock>& blocks) {
  const BlockBounds bounds = BoundsOf(blocks);
  const double x = 0.5 * (bounds.min_x + bounds.max_x);
  const double y = 0.5 * (bounds.min_y + bounds.max_y);
  FittedBody body{Tuple({bounds.max_x - bounds.min_x, bounds.max_y - bounds.min_y, bounds.max_z - bounds.min_z}),
                  Tuple({x, y, 0.0, 0.0}, 5),
                  std::abs(x) < 1e-5 && std::abs(y) < 1e-5,
                  {}};
  for (const DrawnBlock& block : blocks) {
    body.blocks.push_back(WrittenBlock(block.outline, block.z_min, block.z_max));
  }
  return body;
}

bool IsBox(const std::vector<DrawnBlock>& blocks) {
  if (blocks.size() != 1 || blocks[0].outline.size() != 4 || blocks[0].z_min != 0.0) return false;
  const BlockBounds bounds = BoundsOf(blocks);
  return std::all_of(blocks[0].outline.begin(), blocks[0].outline.end(), [&](const Vec2& corner) {
    return (corner.x() == bounds.min_x || corner.x() == bounds.max_x) &&
           (corner.y() == bounds.min_y || corner.y() == bounds.max_y);
  });
}

}  // namespace troupe
