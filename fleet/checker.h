// A checker of VDA 5050: a fold over the messages of both sides, in the order in which they were seen, whose result is
// a list of verdicts: the rule that a message breaks, the finding and the expectation.
//
// It knows what it has seen. A rule that needs more (the first states of a vehicle that was there before, a factsheet
// that was not sent) says nothing. The memory is a plain value. Messages may be hostile: what is kept for a vehicle,
// the number of vehicles and the verdicts about one message are bounded.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fleet/factsheet_message.h"
#include "fleet/order_message.h"
#include "fleet/rules.h"
#include "fleet/state_message.h"
#include "fleet/topic.h"
#include "fleet/zone_message.h"

namespace troupe::fleet {

struct ObservedMessage {
  std::string manufacturer;  // of the topic
  std::string serial_number;
  Topic topic = Topic::kState;
  std::int64_t milliseconds = 0;  // when it was seen
  std::string payload;
  int major_version = 0;  // of the topic; 0: not known
};

struct Verdict {
  Rule rule = Rule::kMessageForm;
  std::uint64_t message = 0;  // counts the observed messages from 0
  std::string vehicle;        // "manufacturer/serialNumber"
  std::string found;
  std::string expected;

  // "Acme/anna, message 7: cancel_clears: found ..., expected ..."
  std::string ToString() const;

  bool operator==(const Verdict&) const = default;
};

inline constexpr std::size_t kMostVerdicts = 16;      // of one rule about one message
inline constexpr std::size_t kMostVehicles = 10'000;  // messages of further ones are not judged

struct CheckerOptions {
  std::optional<Version> version;               // of all messages; none: of each vehicle the one that it states
  std::int64_t answer_milliseconds = 5'000;     // in which a vehicle answers orders and instant actions
  std::int64_t tolerance_milliseconds = 1'000;  // of the longest interval of states
};

// An accepted order as the messages tell it.
struct KnownRoute {
  struct Place {
    std::string id;
    bool is_released = false;

    bool operator==(const Place&) const = default;
  };

  bool is_known = false;  // from its first message on
  std::string order_id;
  std::uint32_t order_update_id = 0;
  std::map<std::uint32_t, Place> nodes;   // by sequence ids
  std::map<std::string, Action> actions;  // of the base, by their ids
  std::map<std::string, Action> horizon_actions;
  std::uint32_t base_end = 0;  // a sequence id
  Node end_node;               // as it was sent

  bool operator==(const KnownRoute&) const = default;
};

struct VehicleRecord {
  struct Sender {
    std::optional<std::uint32_t> header_id;
    std::int64_t timestamp = 0;

    bool operator==(const Sender&) const = default;
  };
  struct SentOrder {
    Order order;
    std::uint64_t message = 0;
    std::int64_t milliseconds = 0;
    bool is_answered = false;

    bool operator==(const SentOrder&) const = default;
  };
  // Before 3.0 an id of an instant action that an order uses, too, tells nothing: both are in one list of states.
  struct ActionUse {
    std::string place;  // "instant action TYPE", or the order
    bool is_ambiguous = false;

    bool operator==(const ActionUse&) const = default;
  };
  struct SentInstantAction {
    Action action;
    std::uint64_t message = 0;
    std::int64_t milliseconds = 0;
    bool is_reported = false;

    bool operator==(const SentInstantAction&) const = default;
  };

  struct SentZoneSet {
    ZoneSet set;  // the first of its id, without a header
    std::uint64_t message = 0;
    std::int64_t milliseconds = 0;
    bool is_answered = false;

    bool operator==(const SentZoneSet&) const = default;
  };

  std::uint64_t messages = 0;
  std::optional<Version> version;
  std::array<Sender, 8> senders;  // by topics
  std::optional<ConnectionState> connection;
  std::optional<Factsheet> factsheet;
  std::optional<State> state;  // the newest
  std::int64_t state_milliseconds = 0;
  std::uint64_t state_message = 0;
  bool is_overdue = false;                          // no state for too long, which was said
  std::map<std::string, std::uint32_t> update_ids;  // the largest that was sent for each order
  std::vector<SentOrder> sent;                      // not yet accepted by a state, the newest last
  std::deque<SentInstantAction> instant_actions;
  std::map<std::string, ActionUse> action_uses;  // the first of each id
  std::map<std::string, SentZoneSet> zone_sets;  // by their ids
  KnownRoute route;
  std::string cancelled_order_id;

  bool operator==(const VehicleRecord&) const = default;
};

struct CheckerMemory {
  std::uint64_t messages = 0;
  std::uint64_t left_out = 0;                     // messages of vehicles beyond kMostVehicles
  std::int64_t swept_milliseconds = 0;            // when all vehicles were looked at
  std::map<std::string, VehicleRecord> vehicles;  // by "manufacturer/serialNumber"

  bool operator==(const CheckerMemory&) const = default;
};

// The verdicts about a message, and about what should have come before it.
std::vector<Verdict> CheckMessage(CheckerMemory& memory, const ObservedMessage& message, const CheckerOptions& options);

// Messages may have been missed: only what vehicles are and may do is still known.
void MissMessages(CheckerMemory& memory);

// The verdicts about what should have come by now, at the end of a sequence and while there are no messages.
std::vector<Verdict> CheckTime(CheckerMemory& memory, std::int64_t milliseconds, const CheckerOptions& options);

}  // namespace troupe::fleet
