// The names of enumerations in messages. The model has the values of all versions; where a version lacks one, it has
// the nearest. Names before 3.0 have no underscores.
#pragma once

#include <string>

#include "fleet/factsheet_message.h"
#include "fleet/order_message.h"
#include "fleet/state_message.h"
#include "fleet/zone_message.h"

namespace troupe::fleet {

// What the versions before 3.0 have in place of a value that is new in it, and the other way round.
template <NamedEnum Value>
constexpr Value InVersion(Value value, Version /*version*/) {
  return value;
}
constexpr ErrorLevel InVersion(ErrorLevel level, Version version) {
  return IsBefore3(version) && level != ErrorLevel::kFatal ? ErrorLevel::kWarning : level;
}
constexpr OperatingMode InVersion(OperatingMode mode, Version version) {
  if (!IsBefore3(version)) return mode;
  if (mode == OperatingMode::kIntervened) return OperatingMode::kManual;
  return mode == OperatingMode::kStartup ? OperatingMode::kService : mode;
}
constexpr ConnectionState InVersion(ConnectionState state, Version version) {
  return IsBefore3(version) && state == ConnectionState::kHibernating ? ConnectionState::kOnline : state;
}
constexpr ActionStatus InVersion(ActionStatus status, Version version) {
  return IsBefore3(version) && status == ActionStatus::kRetriable ? ActionStatus::kRunning : status;
}
constexpr BlockingType InVersion(BlockingType type, Version version) {
  return IsBefore3(version) && type == BlockingType::kSingle ? BlockingType::kHard : type;
}
constexpr EmergencyStop InVersion(EmergencyStop stop, Version version) {
  return !IsBefore3(version) && stop == EmergencyStop::kAutomatic ? EmergencyStop::kNone : stop;
}
constexpr RequestStatus InVersion(RequestStatus status, Version /*version*/) {
  return status == RequestStatus::kQueued ? RequestStatus::kRequested : status;  // the schema lacks QUEUED
}

// The name of a value in the messages of a version.
template <NamedEnum Value>
std::string TextOf(Value value, Version version) {
  std::string name = NameOf(InVersion(value, version));
  if (IsBefore3(version)) std::erase(name, '_');
  return name;
}

}  // namespace troupe::fleet
