// Rows (troupe/fields.h) between their lists and structs of idl/, which have the fields in the same order: a field that
// is a row is a struct or its members, one after another, which follow a flag where the row is optional; a point is x
// and y; a list is a sequence, of points and rectangles one of their numbers; an optional value is a sequence of at
// most one, or a cell (cells.h); the parameters of a sensor are its type and its fields by name. A member that is
// missing, that is none of the fields or that has another type does not compile.
//
// For messages that are rare or sent once for each world: clarity before speed. The order of members in idl/ is the
// order of the list of fields; there are no names at run time.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "transport/dds/binding/wire.h"
#include "transport/dds/convert/cells.h"
#include "transport/dds/convert/convert.h"
#include "troupe/fields.h"
#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "troupe/sensor_description.h"
#include "troupe/shared.h"
#include "troupe/vec2.h"

namespace troupe::dds {

// Of types without a list, in convert_world.cc and convert_frame.cc.
troupe_wire_PixelArea ToWire(const PixelArea& area, WireArena& arena);
Result<PixelArea> FromWire(const troupe_wire_PixelArea& wire);
void ToWire(const SensorParameters& parameters, char*& type, dds_sequence_troupe_wire_SensorField& fields,
            WireArena& arena);
Result<SensorParameters> FromWire(const char* type, const dds_sequence_troupe_wire_SensorField& fields);
void ToWire(const std::vector<HistoryEntry>& entries, dds_sequence_troupe_wire_HistoryEntry& wire, WireArena& arena);
Result<std::vector<HistoryEntry>> FromWire(const dds_sequence_troupe_wire_HistoryEntry& wire);

namespace structs_internal {

template <typename Wire>
inline constexpr bool kIsSequence = requires(Wire wire) {
  wire._buffer;
};
template <typename Value>
inline constexpr std::size_t kNumbers = std::is_same_v<Value, Vec2>        ? 2
                                        : std::is_same_v<Value, Rectangle> ? 4
                                                                           : 0;

template <std::size_t at, typename Members>
using MemberType = std::remove_cvref_t<std::tuple_element_t<at, Members>>;
template <typename Row, std::size_t field>
using PartType = typename std::tuple_element_t<field, std::remove_const_t<decltype(kFields<Row>)>>::Part;

// Whether a row is spread over the members of the struct around it.
template <typename Part, typename Member>
inline constexpr bool kIsSpread = HasFields<Part> && !std::is_class_v<Member>;

// Whether a row is optional, and spread behind a flag that says whether it is there.
template <typename Part, typename Member>
inline constexpr bool kIsFlagged = false;
template <typename Row>
inline constexpr bool kIsFlagged<std::optional<Row>, bool> = HasFields<Row>;

// The place of the member behind a part whose first member is at `at`.
template <typename Part, std::size_t at, typename Members>
constexpr std::size_t PlaceBehind();

// The place of the first member of a field of a row whose first member is at `at`.
template <typename Row, std::size_t field, std::size_t at, typename Members>
constexpr std::size_t PlaceOf() {
  if constexpr (field == 0) {
    return at;
  } else {
    return PlaceBehind<PartType<Row, field - 1>, PlaceOf<Row, field - 1, at, Members>(), Members>();
  }
}

template <typename Part, std::size_t at, typename Members>
constexpr std::size_t PlaceBehind() {
  static_assert(at < std::tuple_size_v<Members>, "a field has no member");
  if constexpr (std::is_same_v<Part, Vec2> || std::is_same_v<Part, SensorParameters>) {
    return at + 2;
  } else if constexpr (kIsSpread<Part, MemberType<at, Members>>) {
    return PlaceOf<Part, kMemberCount<Part>, at, Members>();
  } else if constexpr (kIsFlagged<Part, MemberType<at, Members>>) {
    return PlaceBehind<typename Part::value_type, at + 1, Members>();
  } else {
    return at + 1;
  }
}

// Calls visit.operator()<place>(field) for the fields of a row whose first member is at `at`; until it is false.
template <typename Row, std::size_t at, typename Members, typename Visit>
bool ForEachPlace(const Visit& visit) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return (... && visit.template operator()<PlaceOf<Row, I, at, Members>()>(std::get<I>(kFields<Row>)));
  }
  (std::make_index_sequence<kMemberCount<Row>>());
}

}  // namespace structs_internal

// Fills a struct.
class StructWriter {
 public:
  explicit StructWriter(WireArena& arena) : arena_(arena) {}

  template <typename Row, typename Wire>
  void Write(const Row& row, Wire& wire) {
    const auto members = MembersOf(wire);
    using Members = std::remove_const_t<decltype(members)>;
    static_assert(structs_internal::PlaceOf<Row, kMemberCount<Row>, 0, Members>() == std::tuple_size_v<Members>,
                  "a member is not one of a field");
    WriteMembers<0>(row, members);
  }

 private:
  template <std::size_t at, typename Row, typename Members>
  void WriteMembers(const Row& row, const Members& members) {
    structs_internal::ForEachPlace<Row, at, Members>([&]<std::size_t place>(const auto& field) {
      WritePart<place>(field.Of(row), members);
      return true;
    });
  }

  template <std::size_t at, typename Part, typename Members>
  void WritePart(const Part& part, const Members& members) {
    auto& member = std::get<at>(members);
    if constexpr (std::is_same_v<Part, Vec2>) {
      member = part.x();
      std::get<at + 1>(members) = part.y();
    } else if constexpr (std::is_same_v<Part, SensorParameters>) {
      ToWire(part, member, std::get<at + 1>(members), arena_);
    } else if constexpr (structs_internal::kIsSpread<Part, std::remove_cvref_t<decltype(member)>>) {
      WriteMembers<at>(part, members);
    } else if constexpr (structs_internal::kIsFlagged<Part, std::remove_cvref_t<decltype(member)>>) {
      member = part.has_value();
      if (part) WritePart<at + 1>(*part, members);
    } else {
      WriteValue(part, member);
    }
  }

  template <typename Value, typename Wire>
  void WriteValue(const Value& value, Wire& wire) {
    if constexpr (HasFields<Value>) {
      Write(value, wire);
    } else if constexpr (std::is_same_v<Value, Shared<WorldDescription>>) {
      Write(*value, wire);
    } else if constexpr (std::is_same_v<Value, std::vector<HistoryEntry>>) {
      ToWire(value, wire, arena_);
    } else if constexpr (std::is_same_v<Value, PixelArea>) {
      wire = ToWire(value, arena_);
    } else if constexpr (!structs_internal::kIsSequence<Wire>) {
      wire = ToCell<Wire>(value, arena_);
    } else if constexpr (kIsOptional<Value>) {
      auto* const out = arena_.Fill(wire, value ? 1 : 0);
      if (value) WriteValue(*value, *out);
    } else {
      using Element = typename Value::value_type;
      constexpr std::size_t kNumbers = structs_internal::kNumbers<Element>;
      auto* out = arena_.Fill(wire, value.size() * (kNumbers == 0 ? 1 : kNumbers));
      for (const Element& element : value) {
        if constexpr (kNumbers == 2) {
          *out++ = element.x();
          *out++ = element.y();
        } else if constexpr (kNumbers == 4) {
          ForEachField<Element>([&](const auto& field) { *out++ = field.Of(element); });
        } else {
          WriteValue(element, *out++);
        }
      }
    }
  }

  WireArena& arena_;
};

// Reads a struct. The error names the field with a value that is not of its type: an unknown enumerator, an index below
// -1, numbers that are no points. Other values pass: Validate checks them.
class StructReader {
 public:
  template <typename Wire, typename Row>
  Status Read(const Wire& wire, Row& row) {
    if (ReadRow(wire, row)) return {};
    return Error{{}, path_ + ": " + (problem_.empty() ? "found a value that is not known" : problem_)};
  }

 private:
  template <typename Wire, typename Row>
  bool ReadRow(const Wire& wire, Row& row) {
    return ReadMembers<0>(MembersOf(wire), row);
  }

  template <std::size_t at, typename Row, typename Members>
  bool ReadMembers(const Members& members, Row& row) {
    return structs_internal::ForEachPlace<Row, at, Members>([&]<std::size_t place>(const auto& field) {
      return ReadPart<place>(members, field.Of(row)) || FailAt(field.name);
    });
  }

  template <std::size_t at, typename Part, typename Members>
  bool ReadPart(const Members& members, Part& part) {
    const auto& member = std::get<at>(members);
    if constexpr (std::is_same_v<Part, Vec2>) {
      part = {member, std::get<at + 1>(members)};
      return true;
    } else if constexpr (std::is_same_v<Part, SensorParameters>) {
      return Fits(FromWire(member, std::get<at + 1>(members)), part);
    } else if constexpr (structs_internal::kIsSpread<Part, std::remove_cvref_t<decltype(member)>>) {
      return ReadMembers<at>(members, part);
    } else if constexpr (structs_internal::kIsFlagged<Part, std::remove_cvref_t<decltype(member)>>) {
      part.reset();
      return !member || ReadPart<at + 1>(members, part.emplace());
    } else {
      return ReadValue(member, part);
    }
  }

  template <typename Value, typename Wire>
  bool ReadValue(const Wire& wire, Value& value) {
    if constexpr (HasFields<Value>) {
      return ReadRow(wire, value);
    } else if constexpr (std::is_same_v<Value, Shared<WorldDescription>> ||
                         std::is_same_v<Value, std::vector<HistoryEntry>>) {
      return Fits(FromWire(wire), value);  // as a whole, to be valid
    } else if constexpr (!structs_internal::kIsSequence<Wire>) {
      return FromCell(wire, value);
    } else if constexpr (kIsOptional<Value>) {
      value.reset();
      const auto elements = Elements(wire);
      if (elements.size() > 1) return Fails("found several values, expected at most one");
      if (elements.empty()) return true;
      if constexpr (std::is_same_v<Value, std::optional<PixelArea>>) {
        return Fits(FromWire(elements.front()), value);
      } else {
        return ReadValue(elements.front(), value.emplace());
      }
    } else {
      using Element = typename Value::value_type;
      constexpr std::size_t kNumbers = structs_internal::kNumbers<Element>;
      constexpr std::size_t kStride = kNumbers == 0 ? 1 : kNumbers;
      const auto elements = Elements(wire);
      if (elements.size() % kStride != 0) return false;
      value.resize(elements.size() / kStride);
      auto from = elements.begin();
      for (Element& element : value) {
        if constexpr (kNumbers == 2) {
          element = {from[0], from[1]};
        } else if constexpr (kNumbers == 4) {
          element = {from[0], from[1], from[2], from[3]};
        } else if (!ReadValue(*from, element)) {
          return FailAt(std::to_string(&element - value.data()));
        }
        from += kStride;
      }
      return true;
    }
  }

  template <typename Value, typename Target>
  bool Fits(Result<Value> result, Target& value) {
    if (!result.ok()) return Fails(result.error().message);
    value = std::move(result).value();
    return true;
  }
  bool Fails(std::string problem) {
    problem_ = std::move(problem);
    return false;
  }
  bool FailAt(std::string_view part) {
    path_ = std::string(part) + (path_.empty() ? "" : ".") + path_;
    return false;
  }

  std::string path_;
  std::string problem_;
};

template <typename Wire, typename Row>
Wire WriteStruct(const Row& row, WireArena& arena) {
  Wire wire{};
  StructWriter(arena).Write(row, wire);
  return wire;
}
template <typename Row, typename Wire>
Result<Row> ReadStruct(const Wire& wire) {
  Row row;
  if (Status status = StructReader().Read(wire, row); !status.ok()) return status.error();
  return row;
}

}  // namespace troupe::dds
