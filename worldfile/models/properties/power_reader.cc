#include "worldfile/models/properties/power_reader.h"

#include <algorithm>
#include <optional>
#include <string>

#include "worldfile/text/quote.h"

namespace troupe {
namespace {

constexpr double kMostJoules = 1e12;  // or W, or kg

// The amount in J of the property, or of the one in kJ.
std::optional<double> ReadJoules(PropertyReader& reader, const std::string& name) {
  std::optional<double> joules;
  const std::string thousands = "k" + name;
  if (reader.node().Find(name) != nullptr) joules = reader.Number(name, 0.0, -kMostJoules, kMostJoules);
  if (reader.node().Find(thousands) != nullptr) {
    if (joules) {
      reader.diagnostics().Fail(reader.Where(thousands),
                                "found both " + Quoted(name) + " and " + Quoted(thousands) + ", expected one of them");
    }
    joules = 1000.0 * reader.Number(thousands, 0.0, -kMostJoules / 1000.0, kMostJoules / 1000.0);
  }
  return joules;
}

double ReadRate(PropertyReader& reader, const std::string& name) {
  return reader.Number(name, 0.0, 0.0, kMostJoules);
}

}  // namespace

PowerDescription ReadPower(PropertyReader& reader) {
  PowerDescription power;
  const std::optional<double> joules = ReadJoules(reader, "joules");
  const std::optional<double> capacity = ReadJoules(reader, "joules_capacity");
  if (capacity && *capacity < 0.0) {
    reader.diagnostics().Fail(reader.node().where, "found a negative capacity for energy, expected at least 0");
  }
  power.has_store = joules || capacity;
  power.endless = joules && *joules < 0.0;
  power.capacity = power.endless ? 0.0 : std::max(0.0, capacity.value_or(joules.value_or(0.0)));
  power.joules = power.endless ? 0.0 : std::min(joules.value_or(power.capacity), power.capacity);
  power.watts = ReadRate(reader, "watts");
  power.mass = ReadRate(reader, "mass");
  power.give_watts = ReadRate(reader, "give_watts");
  power.take_watts = ReadRate(reader, "take_watts");
  return power;
}

}  // namespace troupe
