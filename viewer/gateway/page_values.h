// PageValue: the values of fields (troupe/fields.h) on the page, of each type its bytes, its TypeScript and the
// expression that reads it from a Reader `r` (viewer/web/src/protocol.ts). A row is an object of its fields, so that
// states, descriptions and readings need no line for a field. viewer/web/write_rows.cc makes the page's types from it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/bytes.h"
#include "troupe/color.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/sensor.h"
#include "troupe/shared.h"
#include "troupe/vec2.h"
#include "troupe/world_description.h"

namespace troupe {

// PageWriter: appends to the bytes of a message for the page.
class PageWriter : public ByteWriter<std::string> {
 public:
  using ByteWriter::ByteWriter;

  void WriteFlag(bool value) { Write(static_cast<std::uint8_t>(value ? 1 : 0)); }
  void WriteCount(std::size_t count) { Write(static_cast<std::uint32_t>(count)); }
  void WriteFloat(double value) { Write(static_cast<float>(value)); }

  // A count whose value is known later. REQUIRES of FillCount: `place` is from ReserveCount.
  std::size_t ReserveCount() {
    WriteCount(0);
    return size() - sizeof(std::uint32_t);
  }
  void FillCount(std::size_t place, std::size_t count) { Replace(place, static_cast<std::uint32_t>(count)); }
};

// "charge_watts": chargeWatts, or ChargeWatts.
inline std::string CamelCase(std::string_view name, bool starts_upper = false) {
  std::string text;
  bool is_upper = starts_upper;
  for (const char c : name) {
    if (c != '_') text += is_upper ? static_cast<char>(c - 'a' + 'A') : c;
    is_upper = c == '_';
  }
  return text;
}

// The fields that the page shows. Others are most of the bytes of their readings.
template <typename Row>
constexpr bool IsShownField([[maybe_unused]] std::string_view field) {
  if constexpr (std::is_same_v<Row, RangerReading>) return field != "intensities";
  if constexpr (std::is_same_v<Row, CameraReading>) return field != "depths" && field != "models";
  return true;
}

// A row or an enumeration.
template <typename Value>
struct PageValue {
  static_assert(HasFields<Value> || std::is_enum_v<Value>, "the page has no type for a field");

  static std::string Type() { return HasFields<Value> ? "{" + Members() + "}" : "number"; }
  static std::string Read() { return HasFields<Value> ? "{" + MemberReads() + "}" : "r.u8()"; }
  static void Write(PageWriter& writer, const Value& value) {
    if constexpr (HasFields<Value>) {
      ForEachOnPage(
          [&]<typename Part>(const Field<Value, Part>& field) { PageValue<Part>::Write(writer, field.Of(value)); });
    } else {
      writer.Write(static_cast<std::uint8_t>(value));
    }
  }

  // "pose: Pose; fov: number; "
  static std::string Members() {
    std::string text;
    ForEachOnPage([&]<typename Part>(const Field<Value, Part>& field) {
      text += CamelCase(field.name) + ": " + PageValue<Part>::Type() + "; ";
    });
    return text;
  }
  // "pose: r.pose(), fov: r.f64(), "
  static std::string MemberReads() {
    std::string text;
    ForEachOnPage([&]<typename Part>(const Field<Value, Part>& field) {
      text += CamelCase(field.name) + ": " + PageValue<Part>::Read() + ", ";
    });
    return text;
  }

 private:
  template <typename Visit>
  static void ForEachOnPage(const Visit& visit) {
    if constexpr (HasFields<Value>) {
      ForEachField<Value>([&](const auto& field) {
        if (IsShownField<Value>(field.name)) visit(field);
      });
    }
  }
};

// Integers of 64 bits are exact on the page up to 2^53. Indices have 64 everywhere, also in the page's own module.
template <typename Number>
requires std::is_arithmetic_v<Number>
struct PageValue<Number> {
  static std::string Type() { return "number"; }
  static std::string Read() {
    if constexpr (std::is_same_v<Number, std::size_t>) return "Number(r.u64())";
    const std::string kind = std::is_floating_point_v<Number> ? "f" : std::is_signed_v<Number> ? "i" : "u";
    const std::string call = "r." + kind + std::to_string(8 * sizeof(Number)) + "()";
    return std::is_integral_v<Number> && sizeof(Number) == 8 ? "Number(" + call + ")" : call;
  }
  static void Write(PageWriter& writer, Number value) {
    if constexpr (std::is_same_v<Number, std::size_t>) {
      writer.Write(static_cast<std::uint64_t>(value));
    } else {
      writer.Write(value);
    }
  }
};

template <>
struct PageValue<bool> {
  static std::string Type() { return "boolean"; }
  static std::string Read() { return "r.flag()"; }
  static void Write(PageWriter& writer, bool value) { writer.WriteFlag(value); }
};

template <>
struct PageValue<std::string> {
  static std::string Type() { return "string"; }
  static std::string Read() { return "r.text()"; }
  static void Write(PageWriter& writer, std::string_view text) { writer.WriteText(text); }
};

template <typename Tag>
struct PageValue<Id<Tag>> {
  static std::string Type() { return "number"; }
  static std::string Read() { return "r.u32()"; }
  static void Write(PageWriter& writer, Id<Tag> id) { writer.WriteCount(id.index()); }
};

// -1: none.
template <typename Tag>
struct PageValue<std::optional<Id<Tag>>> {
  static std::string Type() { return "number"; }
  static std::string Read() { return "r.i32()"; }
  static void Write(PageWriter& writer, const std::optional<Id<Tag>>& id) {
    writer.Write(id ? static_cast<std::int32_t>(id->index()) : std::int32_t{-1});
  }
};

template <typename Value>
struct PageValue<std::optional<Value>> {
  static std::string Type() { return PageValue<Value>::Type() + " | null"; }
  static std::string Read() { return "r.flag() ? " + PageValue<Value>::Read() + " : null"; }
  static void Write(PageWriter& writer, const std::optional<Value>& value) {
    writer.WriteFlag(value.has_value());
    if (value) PageValue<Value>::Write(writer, *value);
  }
};

template <typename Value>
struct PageValue<Shared<Value>> : PageValue<Value> {
  static void Write(PageWriter& writer, const Shared<Value>& value) { PageValue<Value>::Write(writer, *value); }
};

// Numbers and bytes are typed arrays.
template <typename Element>
struct PageValue<std::vector<Element>> {
  static constexpr bool kIsArray = std::is_floating_point_v<Element> || std::is_same_v<Element, std::uint8_t>;

  static std::string Type() {
    if (std::is_same_v<Element, double>) return "Float64Array";
    if (std::is_same_v<Element, float>) return "Float32Array";
    return kIsArray ? "Uint8Array" : "Array<" + PageValue<Element>::Type() + ">";
  }
  static std::string Read() {
    if (std::is_same_v<Element, double>) return "r.doubles(r.u32())";
    if (std::is_same_v<Element, float>) return "r.floats(r.u32())";
    return kIsArray ? "r.bytes(r.u32())" : "r.list(() => (" + PageValue<Element>::Read() + "))";
  }
  static void Write(PageWriter& writer, const std::vector<Element>& list) {
    writer.WriteCount(list.size());
    if constexpr (kIsArray) {
      writer.WriteBytes(std::as_bytes(std::span(list)));
    } else {
      for (const Element& element : list) PageValue<Element>::Write(writer, element);
    }
  }
};

template <>
struct PageValue<Vec2> {
  static std::string Type() { return "{x: number; y: number}"; }
  static std::string Read() { return "{x: r.f64(), y: r.f64()}"; }
  static void Write(PageWriter& writer, const Vec2& point) {
    writer.Write(double{point.x()});
    writer.Write(double{point.y()});
  }
};

template <>
struct PageValue<Pose> {
  static std::string Type() { return "Pose"; }
  static std::string Read() { return "r.pose()"; }
  static void Write(PageWriter& writer, const Pose& pose) {
    for (const double number : {pose.x, pose.y, pose.z, pose.heading}) writer.Write(number);
  }
};

template <>
struct PageValue<Twist> {
  static std::string Type() { return "Twist"; }
  static std::string Read() { return "r.twist()"; }
  static void Write(PageWriter& writer, const Twist& twist) {
    for (const double number : {twist.vx, twist.vy, twist.wz}) writer.WriteFloat(number);
  }
};

template <>
struct PageValue<Color> {
  static std::string Type() { return "Color"; }
  static std::string Read() { return "r.color()"; }
  static void Write(PageWriter& writer, const Color& color) {
    for (const double number : {color.r, color.g, color.b, color.a}) writer.WriteFloat(number);
  }
};

// As the page draws it: blocks, rectangles with their outlines, and the pixels of an area.
template <>
struct PageValue<Shape> {
  static std::string Type() { return "Shape"; }
  static std::string Read() { return "r.shape()"; }
  static void Write(PageWriter& writer, const Shape& shape);  // page_messages.cc
};

// The type alone: readings have the geometry that the page shows.
template <>
struct PageValue<SensorParameters> {
  static std::string Type() { return "{type: string}"; }
  static std::string Read() { return "{type: r.text()}"; }
  static void Write(PageWriter& writer, const SensorParameters& parameters) { writer.WriteText(TypeOf(parameters)); }
};

// An object of each kind of reading, with the type of the sensor as its `kind`; "none" before the first measurement.
using ReadingContent = decltype(SensorReading::content);
template <>
struct PageValue<ReadingContent> {
  static std::string Type() {
    std::string text = "{kind: 'none'}";
    ForEachKind([&]<typename Kind>(std::string_view name) {
      text += "\n  | {kind: '" + std::string(name) + "'; " + PageValue<Kind>::Members() + "}";
    });
    return text;
  }
  static std::string Read() {
    std::string text = "r.variant<Content>([\n  () => ({kind: 'none'}),\n";
    ForEachKind([&]<typename Kind>(std::string_view name) {
      text += "  () => ({kind: '" + std::string(name) + "', " + PageValue<Kind>::MemberReads() + "}),\n";
    });
    return text + "])";
  }
  static void Write(PageWriter& writer, const ReadingContent& content) {
    writer.Write(static_cast<std::uint8_t>(content.index()));
    std::visit(
        [&]<typename Kind>(const Kind& kind) {
          if constexpr (HasFields<Kind>) PageValue<Kind>::Write(writer, kind);
        },
        content);
  }

 private:
  static_assert(std::variant_size_v<ReadingContent> == std::variant_size_v<SensorParameters> + 1);

  // Calls visit.operator()<Kind>(type of the sensor), in the order of the variant.
  template <typename Visit>
  static void ForEachKind(const Visit& visit) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (visit.template operator()<std::variant_alternative_t<I + 1, ReadingContent>>(
           std::variant_alternative_t<I, SensorParameters>::kType),
       ...);
    }
    (std::make_index_sequence<std::variant_size_v<SensorParameters>>());
  }
};

}  // namespace troupe
