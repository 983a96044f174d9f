// Entity: a handle of Cyclone DDS that its owner deletes; with the errors of DDS, durations, statuses and the prefixes
// of GUIDs.
//
// Closing an entity waits for its listener calls, and deletes the entities made from it. So an owner of readers and
// writers closes them before the objects that their listeners use; members are declared in that order.
#pragma once

#include <dds/dds.h>

#include <array>
#include <compare>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::dds {

// Entity: owner of a handle of Cyclone DDS. Deleting it deletes the entities that were created from it. Move-only.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    if (this != &other) {
      close();
      handle_ = std::exchange(other.handle_, 0);
    }
    return *this;
  }
  ~Entity() { close(); }

  // The handle for Cyclone's C functions; 0 if there is none.
  dds_entity_t handle() const { return handle_; }
  bool is_open() const { return handle_ != 0; }

  // Deletes the entity. Waits for its listeners to return, so never call it from one.
  void close() noexcept {
    if (handle_ != 0) dds_delete(handle_);
    handle_ = 0;  // not before: a listener may still be reading it
  }

 private:
  dds_entity_t handle_ = 0;
};

// Exception: a DDS call failed. The text names the operation, and the return code in words.
class Exception : public std::runtime_error {
 public:
  // `doing` completes the sentence "while ...": "creating topic 'troupe/frame'".
  Exception(dds_return_t code, const std::string& doing);

  dds_return_t code() const { return code_; }

 private:
  dds_return_t code_;
};

// Returns `result` (a handle, a count or OK). Throws Exception if it is a failure.
template <typename Doing>
dds_return_t Check(dds_return_t result, const Doing& doing) {
  if (result < 0) throw Exception(result, doing);
  return result;
}

// Durations of DDS, from seconds.

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();  // s

// Negative durations become zero, durations beyond the range of DDS infinite.
inline dds_duration_t ToDuration(double seconds) {
  if (!(seconds < 9.0e9)) return DDS_INFINITY;
  return seconds > 0.0 ? static_cast<dds_duration_t>(seconds * 1e9) : 0;
}

inline double ToSeconds(dds_duration_t duration) {
  return duration == DDS_INFINITY ? kInfinite : static_cast<double>(duration) * 1e-9;
}

// GuidPrefix: the identity of a participant on the network, which all of its readers and writers share.
struct GuidPrefix {
  std::array<std::uint8_t, 12> bytes{};
  auto operator<=>(const GuidPrefix&) const = default;
};

// The prefix of any entity of a participant.
GuidPrefix PrefixOf(const dds_guid_t& guid);

// 24 lower-case hexadecimal digits.
std::string ToText(const GuidPrefix& prefix);
std::optional<GuidPrefix> ParseGuidPrefix(std::string_view text);

// Communication statuses, named as in the C++ PSM.

using PublicationMatchedStatus = dds_publication_matched_status_t;
using SubscriptionMatchedStatus = dds_subscription_matched_status_t;
using LivelinessChangedStatus = dds_liveliness_changed_status_t;
using OfferedIncompatibleQosStatus = dds_offered_incompatible_qos_status_t;
using RequestedIncompatibleQosStatus = dds_requested_incompatible_qos_status_t;

// Listeners: functions that Cyclone calls on a thread of its own when a status has changed. Inside one, write() and
// take() are allowed; creating or deleting entities is not.
//
// An exception never reaches Cyclone, which is C: it is passed to on_exception, or printed on standard error if that is
// empty.

struct DataReaderListener {
  std::function<void()> on_data_available;
  std::function<void(const SubscriptionMatchedStatus&)> on_subscription_matched;
  std::function<void(const LivelinessChangedStatus&)> on_liveliness_changed;
  std::function<void(const RequestedIncompatibleQosStatus&)> on_requested_incompatible_qos;
  std::function<void(std::exception_ptr)> on_exception;
};

struct DataWriterListener {
  std::function<void(const PublicationMatchedStatus&)> on_publication_matched;
  std::function<void(const OfferedIncompatibleQosStatus&)> on_offered_incompatible_qos;
  std::function<void(std::exception_ptr)> on_exception;
};

// Make `entity` (a reader, a writer) call `listener`, which must outlive it or the next call for the same entity.
void SetListener(dds_entity_t entity, const DataReaderListener& listener);
void SetListener(dds_entity_t entity, const DataWriterListener& listener);

// No listener call runs any more when it returns. Never call it from a listener of the same entity.
void ClearListener(dds_entity_t entity) noexcept;

}  // namespace troupe::dds
