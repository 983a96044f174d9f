// Properties of world files that are fields of a description: numbers, whole numbers and flags, by the names, units,
// limits and defaults of the field's line in the description (troupe/fields.h).
//
// ReadFields is how such a type is read, and AppendFields how forms and tests know its properties: a new field of
// DoorDescription, LiftDescription, RadioParameters or ImuParameters is a property as soon as it is in the list. Texts,
// tuples, lists and numbers that a file states in another way are read by the type itself.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "troupe/fields.h"
#include "worldfile/models/properties/property_reader.h"
#include "worldfile/models/types/property_table.h"

namespace troupe {

template <typename Part>
inline constexpr bool kIsProperty =
    std::is_same_v<Part, double> || std::is_same_v<Part, std::int32_t> || std::is_same_v<Part, bool>;

// The values of these properties, in SI units. The default is the present one.
double ReadField(PropertyReader& reader, const FieldInfo& field, double otherwise);
std::int32_t ReadField(PropertyReader& reader, const FieldInfo& field, std::int32_t otherwise);
bool ReadField(PropertyReader& reader, const FieldInfo& field, bool otherwise);

template <typename Row>
void ReadFields(PropertyReader& reader, Row& row) {
  ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
    if constexpr (kIsProperty<Part>) field.Of(row) = ReadField(reader, field, field.Of(row));
  });
}

// `initial`: the default, in SI units.
PropertyHelp HelpOf(std::string_view type, const FieldInfo& field, double initial);
PropertyHelp HelpOf(std::string_view type, const FieldInfo& field, std::int32_t initial);
PropertyHelp HelpOf(std::string_view type, const FieldInfo& field, bool initial);

template <typename Row>
void AppendFields(std::string_view type, std::vector<PropertyHelp>& table) {
  const Row row{};
  ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
    if constexpr (kIsProperty<Part>) table.push_back(HelpOf(type, field, field.Of(row)));
  });
}

}  // namespace troupe
