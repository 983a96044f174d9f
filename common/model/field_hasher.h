// FieldHasher: the hash of rows and descriptions, from their lists of fields (troupe/fields.h).
//
// The order of the fields, their types and the rules below are a part of the format: agents and recordings compare
// these hashes, so that a changed rule makes old recordings differ. Names of fields do not count. Doubles count by
// their bits (Hasher).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "common/base/hash.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/shared.h"
#include "troupe/vec2.h"
#include "troupe/world_description.h"

namespace troupe {

class FieldHasher {
 public:
  // A list counts with its length; the value of an optional follows a flag, and a kind of a variant its number.
  template <typename Value>
  void Add(const Value& value) {
    if constexpr (std::is_same_v<Value, Shape>) {
      AddShape(value);
    } else if constexpr (HasFields<Value>) {
      ForEachField<Value>([&](const auto& field) { Add(field.Of(value)); });
    } else if constexpr (std::is_same_v<Value, double>) {
      hasher_.Add(value);
    } else if constexpr (std::is_same_v<Value, std::string>) {
      hasher_.Add(std::string_view(value));
    } else if constexpr (std::is_same_v<Value, std::vector<std::uint8_t>>) {
      hasher_.Add(std::string_view(reinterpret_cast<const char*>(value.data()), value.size()));
    } else if constexpr (std::is_same_v<Value, Vec2>) {
      hasher_.Add(double{value.x()});
      hasher_.Add(double{value.y()});
    } else if constexpr (kIsId<Value>) {
      AddNumber(value.index());
    } else if constexpr (kIsOptionalId<Value>) {
      AddNumber(value ? value->index() + 1 : 0);
    } else if constexpr (kIsOptional<Value>) {
      AddNumber(value.has_value());
      if (value) Add(*value);
    } else if constexpr (kIsList<Value>) {
      AddNumber(value.size());
      for (const auto& element : value) Add(element);
    } else if constexpr (std::is_same_v<Value, SensorParameters>) {
      AddNumber(value.index());
      std::visit([&](const auto& kind) { Add(kind); }, value);
    } else if constexpr (std::is_integral_v<Value> || std::is_enum_v<Value>) {
      AddNumber(value);
    } else {
      Add(*value);  // Shared
    }
  }

  std::uint64_t value() const { return hasher_.value(); }

 private:
  template <typename Number>
  void AddNumber(Number number) {
    hasher_.Add(static_cast<std::uint64_t>(number));
  }
  // An area counts as the list of its rectangles, or of blocks where it is turned: the hash is that of the geometry.
  void AddShape(const Shape& shape);

  Hasher hasher_;
};

}  // namespace troupe
