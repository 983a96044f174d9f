// RandomRows: rows (troupe/fields.h) with every field filled in at random, within its limits.
// It is driven by the list of fields: a field that is added to a row is at once part of every test of forms and
// messages.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/sensor_description.h"
#include "troupe/vec2.h"
#include "troupe/world_description.h"

namespace troupe::test {

class RandomRows {
 public:
  explicit RandomRows(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t Bits() { return engine_(); }
  std::uint64_t Below(std::uint64_t count) { return engine_() % count; }
  bool Coin() { return Below(2) == 1; }
  double Number(double min = -100.0, double max = 100.0) {
    return std::uniform_real_distribution<double>(min, max)(engine_);
  }
  std::string Text() {
    std::string text(Below(12), ' ');
    for (char& c : text) c = static_cast<char>(1 + Below(255));
    return text;
  }

  // Lists have up to three elements. Ids and areas of pixels stay as they are; no sensor is a gripper's break beam.
  template <typename Value>
  void Fill(Value& value, const FieldInfo& field = {}) {
    if constexpr (std::is_same_v<Value, Interval> || std::is_same_v<Value, ZRange>) {
      Fill(value.min, field);
      Fill(value.max, field);
      if (value.min > value.max) std::swap(value.min, value.max);
    } else if constexpr (HasFields<Value>) {
      ForEachField<Value>([&](const auto& part) { Fill(part.Of(value), part); });
    } else if constexpr (std::is_same_v<Value, double>) {
      value = FillNumber(field.limits);
    } else if constexpr (std::is_same_v<Value, Vec2>) {
      value = {FillNumber(field.limits), FillNumber(field.limits)};
    } else if constexpr (std::is_same_v<Value, std::string>) {
      value = Text();
    } else if constexpr (std::is_same_v<Value, bool>) {
      value = Coin();
    } else if constexpr (std::is_enum_v<Value>) {
      value = static_cast<Value>(Below(static_cast<std::uint64_t>(LastOf(Value())) + 1));
    } else if constexpr (std::is_integral_v<Value>) {
      using Limits = std::numeric_limits<Value>;
      const bool is_any = !field.limits.has_min() && !field.limits.has_max();
      const double min = std::max(static_cast<double>(Limits::min()), -1000.0);
      const double max = std::min(static_cast<double>(Limits::max()), 1000.0);
      value = static_cast<Value>(is_any ? Number(min, max) : FillNumber(field.limits));
    } else if constexpr (kIsList<Value>) {
      value.resize(Below(4));
      for (auto& element : value) Fill(element, field);
    } else if constexpr (std::is_same_v<Value, SensorParameters>) {
      constexpr std::size_t kBreakBeam = 1;
      const std::size_t kind = Below(std::variant_size_v<SensorParameters>);
      FillKind(value, kind == kBreakBeam ? 0 : kind);
    } else if constexpr (requires { value.valueless_by_exception(); }) {
      FillKind(value, Below(std::variant_size_v<Value>));
    } else if constexpr (kIsOptional<Value>) {
      FillOptional(value, field);
    } else if constexpr (requires { value.Change(); }) {
      Fill(value.Change(), field);
    } else {
      static_assert(kIsId<Value>);
    }
  }

  // A variant, with the alternative of this number.
  template <std::size_t kind = 0, typename Variant>
  void FillKind(Variant& value, std::size_t number) {
    if constexpr (kind < std::variant_size_v<Variant>) {
      if (number != kind) return FillKind<kind + 1>(value, number);
      Fill(value.template emplace<kind>());
    }
  }

 private:
  double FillNumber(const FieldLimits& limits) {
    const double min = limits.has_min() ? limits.min : std::min(-100.0, limits.max - 100.0);
    const double max = limits.has_max() ? limits.max : std::max(min, 0.0) + 100.0;
    return std::min(max, limits.is_min_excluded ? Number(min + 1e-3, max) : Number(min, max));
  }
  template <typename Value>
  void FillOptional(std::optional<Value>& value, const FieldInfo& field) {
    if constexpr (!kIsId<Value> && !std::is_same_v<Value, PixelArea>) {
      value.reset();
      if (Coin()) Fill(value.emplace(), field);
    }
  }

  std::mt19937_64 engine_;
};

}  // namespace troupe::test
