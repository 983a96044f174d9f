// Messages of VDA 5050 as JSON: written strictly by the public schemas of the version, read as real fleets and vehicles
// send them. Each deviation that reading accepts has a name (Lenience); all others are faults with the place in the
// message (a JSON pointer, RFC 6901), the finding there and the expectation.
//
// Messages come from the network: size, number of values and depth are limited before memory is spent, and a fault
// never throws. Members that the standard does not have are ignored, as it says.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/json_tree.h"
#include "fleet/factsheet_message.h"
#include "fleet/order_message.h"
#include "fleet/state_message.h"
#include "fleet/zone_message.h"

namespace troupe::fleet {

struct MessageFault {
  std::string pointer;  // "/nodes/2/sequenceId"; empty: the message as a whole
  std::string text;     // "found the string 'a', expected a number"

  // "/nodes/2/sequenceId: found the string 'a', expected a number"
  std::string ToString() const;

  bool operator==(const MessageFault&) const = default;
};

enum class Lenience : std::uint8_t {
  kNumberAsString,       // "3.5" for 3.5
  kBooleanAsString,      // "true" for true
  kBooleanAsNumber,      // 1 for true
  kStringAsNumber,       // 17 for "17"
  kNullForMissing,       // null for a member that may be missing
  kMissingList,          // no member for an empty list
  kOtherName,            // the name of another version: actionName, allowedDeviationXy, nodeDescriptor
  kOtherForm,            // the form of another version: a number for an ellipse
  kEnumerationSpelling,  // "none" for NONE, CONNECTION_BROKEN for CONNECTIONBROKEN
  kAngleOutOfRange,      // 4.0 for 4.0 - 2 pi
  kTimestampForm,        // without a Z, or with an offset
};
constexpr auto NamesOf(Lenience) {
  return std::array{"number_as_string",     "boolean_as_string",  "boolean_as_number", "string_as_number",
                    "null_for_missing",     "missing_list",       "other_name",        "other_form",
                    "enumeration_spelling", "angle_out_of_range", "timestamp_form"};
}

struct LenientPlace {
  Lenience lenience = Lenience::kNumberAsString;
  std::string pointer;

  bool operator==(const LenientPlace&) const = default;
};

struct DecodeLimits {
  std::size_t bytes = 4u << 20;
  std::size_t values = 250'000;
};

inline constexpr std::size_t kMaxMessageFaults = 16;  // further ones are not listed
inline constexpr std::size_t kMaxLenientPlaces = 64;

template <typename Message>
struct Decoded {
  Message message;  // what could be read, also of a message with faults
  std::vector<MessageFault> faults;
  std::vector<LenientPlace> lenient;

  bool ok() const { return faults.empty(); }
};

// Message: Order, InstantActions, State, Connection, Visualization, Factsheet, ZoneSet or Responses.
template <typename Message>
Decoded<Message> Decode(std::string_view payload, Version version, const DecodeLimits& limits = {});

// One line of JSON. REQUIRES: numbers are finite. What the version has no value for (a mode, a level) becomes the
// nearest that it has.
template <typename Message>
std::string Encode(const Message& message, Version version);

}  // namespace troupe::fleet
