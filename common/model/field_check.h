// FieldCheck: checks rows and descriptions by their lists of fields (troupe/fields.h): numbers within the limits of
// their fields, intervals that do not end before they begin, known enumerators, ids of the world.
//
// One check for descriptions, states and parameters: a new field is checked as soon as it is in the list. It answers
// for single values only; rules between fields (parents before children, unit vectors) are in validate_world.cc and its
// like. NaN fails every limit. The first problem is named by its path. No allocation without a problem.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "common/geometry/limits.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/interval.h"
#include "troupe/result.h"
#include "troupe/vec2.h"
#include "troupe/world_description.h"
#include "troupe/z_range.h"

namespace troupe {

class FieldCheck {
 public:
  // `world`: of the ids; null: any ids pass. Numbers of fields without a largest one are at most `magnitude`.
  explicit FieldCheck(const WorldDescription* world, double magnitude = kMaxMagnitude)
      : world_(world), magnitude_(magnitude) {}

  // False at the first problem.
  template <typename Row>
  bool Check(const Row& row) {
    static_assert(HasFields<Row>);
    return CheckValue(row, {});
  }

  // One value, by the limits of its field; the path of its problem begins below the field.
  template <typename Value>
  bool CheckField(const Value& value, const FieldInfo& field) {
    return CheckValue(value, field);
  }

  // "drive.wheelbase: found 0, expected above 0 m", after Check has failed.
  const std::string& problem() const { return problem_; }

 private:
  template <typename Value>
  bool CheckValue(const Value& value, const FieldInfo& field) {
    if constexpr (std::is_same_v<Value, Interval> || std::is_same_v<Value, ZRange>) {
      if (!CheckNumber(value.min, field)) return FailAt("min");
      if (!CheckNumber(value.max, field)) return FailAt("max");
      return value.min <= value.max ||
             Fail("an interval from " + TextOf(value.min, field) + " to " + TextOf(value.max, field),
                  "an end that is not below its beginning");
    } else if constexpr (HasFields<Value>) {
      if constexpr (HasFreeNumbersOnly<Value>()) {
        if (AreFine(value)) return true;
      }
      const auto check = [&](const auto& part) { return CheckValue(part.Of(value), part) || FailAt(part.name); };
      return std::apply([&](const auto&... part) { return (... && check(part)); }, kFields<Value>);
    } else if constexpr (std::is_same_v<Value, double>) {
      return CheckNumber(value, field);
    } else if constexpr (std::is_same_v<Value, Vec2>) {
      if (!CheckNumber(value.x(), field)) return FailAt("x");
      return CheckNumber(value.y(), field) || FailAt("y");
    } else if constexpr (std::is_enum_v<Value>) {
      return value <= LastOf(value) || Fail(std::to_string(static_cast<int>(value)), "a known kind");
    } else if constexpr (kIsId<Value>) {
      return world_ == nullptr || value.index() < CountOf(value) ||
             Fail(std::to_string(value.index()), "one of " + std::to_string(CountOf(value)));
    } else if constexpr (kIsOptional<Value>) {
      return !value || CheckValue(*value, field);
    } else if constexpr (kIsList<Value> && !std::is_same_v<Value, std::vector<std::uint8_t>>) {  // any bytes will do
      for (std::size_t i = 0; i < value.size(); ++i) {
        if (!CheckValue(value[i], field)) return FailAt(std::to_string(i));
      }
      return true;
    } else if constexpr (std::is_same_v<Value, SensorParameters>) {
      return std::visit([&](const auto& kind) { return CheckValue(kind, field); }, value);
    } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
      return field.limits.Contain(static_cast<double>(value)) || Fail(std::to_string(value), Expected(field));
    } else if constexpr (requires { *value; }) {
      return CheckValue(*value, field);  // Shared
    } else {
      return true;  // flags, texts and areas: any
    }
  }

  // Poses and twists, most of what a state is: numbers without limits of their own.
  template <typename Value>
  static constexpr bool HasFreeNumbersOnly() {
    const auto is_free = []<typename Part>(const Field<Value, Part>& part) {
      return std::is_same_v<Part, double> && part.limits == FieldLimits();
    };
    return std::apply([&](const auto&... part) { return (... && is_free(part)); }, kFields<Value>);
  }
  // Without the limits of each; a problem is then found one by one.
  template <typename Value>
  bool AreFine(const Value& value) const {
    return std::apply([&](const auto&... part) { return (... && (std::abs(part.Of(value)) <= magnitude_)); },
                      kFields<Value>);
  }

  bool CheckNumber(double number, const FieldInfo& field) {
    const bool is_fine = field.limits.Contain(number) && (field.limits.has_max() || std::abs(number) <= magnitude_);
    return is_fine || FailNumber(number, field);
  }

  std::size_t CountOf(ModelId) const { return world_->models.size(); }
  std::size_t CountOf(RobotId) const { return world_->robots.size(); }
  std::size_t CountOf(ShapeId) const { return world_->shapes.size(); }
  std::size_t CountOf(JointId) const { return world_->joints.size(); }
  std::size_t CountOf(GripperId) const { return world_->grippers.size(); }
  std::size_t CountOf(ObjectId) const { return world_->objects.size(); }
  std::size_t CountOf(PersonId) const { return world_->people.size(); }

  static std::string TextOf(double number);
  static std::string TextOf(double number, const FieldInfo& field);
  static std::string Expected(const FieldInfo& field);
  bool FailNumber(double number, const FieldInfo& field);  // returns false, as the next
  bool Fail(const std::string& found, const std::string& expected);
  bool FailAt(std::string_view part);  // of which the problem is

  const WorldDescription* world_;
  double magnitude_;
  std::string problem_;
};

}  // namespace troupe
