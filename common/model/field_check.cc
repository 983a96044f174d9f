#include "common/model/field_check.h"

#include <cmath>
#include <sstream>

#include "troupe/pose.h"

namespace troupe {

namespace {

// Angles are told in degrees, as in world files.
bool IsAngle(const FieldInfo& field) {
  return field.unit.starts_with("rad");
}

}  // namespace

std::string FieldCheck::TextOf(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

std::string FieldCheck::TextOf(double number, const FieldInfo& field) {
  return TextOf(IsAngle(field) ? number * 180.0 / kPi : number);
}

bool FieldCheck::FailNumber(double number, const FieldInfo& field) {
  const bool is_near = std::abs(number) <= magnitude_;
  if (is_near || field.limits.has_max()) return Fail(TextOf(number, field), Expected(field));
  return Fail(TextOf(number, field),
              magnitude_ > kMaxMagnitude ? "a finite number" : "at most " + TextOf(magnitude_) + " in size");
}

std::string FieldCheck::Expected(const FieldInfo& field) {
  const auto& [min, max, is_min_excluded] = field.limits;
  std::string unit = field.unit.empty() ? "" : " " + std::string(field.unit);
  if (IsAngle(field)) unit.replace(1, 3, "degrees");
  if (field.limits.has_min() && field.limits.has_max() && !is_min_excluded) {
    return "from " + TextOf(min, field) + " to " + TextOf(max, field) + unit;
  }
  std::string text;
  if (field.limits.has_min()) text = (is_min_excluded ? "above " : "at least ") + TextOf(min, field);
  if (field.limits.has_max()) text += (text.empty() ? "at most " : " and at most ") + TextOf(max, field);
  return text + unit;
}

bool FieldCheck::Fail(const std::string& found, const std::string& expected) {
  problem_ = ": found " + found + ", expected " + expected;
  return false;
}

bool FieldCheck::FailAt(std::string_view part) {
  // Built from the inside out, while the recursion returns.
  problem_ = std::string(part) + (problem_.starts_with(':') ? "" : ".") + problem_;
  return false;
}

}  // namespace troupe
