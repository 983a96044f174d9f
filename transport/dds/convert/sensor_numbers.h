// The parameters of sensors as named lists of numbers: the form in which idl/world.idl has them. A pose is x, y, z and
// heading, an interval its minimum and its maximum, a list its length and its elements.
//
// Numbers by name, and no struct for each kind, so that a new kind or field of a sensor needs no change of idl/.
// Reading is strict: every field of the kind, in its order, with exactly its numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"
#include "troupe/sensor_description.h"

namespace troupe::dds {

struct NamedNumbers {
  std::string name;
  std::vector<double> numbers;
};

// By field, in the order of the kind's list.
std::vector<NamedNumbers> NumbersOf(const SensorParameters& parameters);
// The inverse. The error names the type or the field that is not known or not complete.
Result<SensorParameters> ParametersFrom(std::string_view type, const std::vector<NamedNumbers>& fields);

}  // namespace troupe::dds
