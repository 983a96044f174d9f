// Qos: a set of policies as a value. Policies that were not set have the default of DDS.
//   Qos() << Reliability::Reliable(1.0) << History::KeepLast(1)
// Durations are in seconds.
//
// Later policies replace earlier ones of the same kind, so that a profile can be refined: Frame() <<
// History::KeepLast(8).
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "transport/dds/binding/entity.h"

namespace troupe::dds {

struct Reliability {
  dds_reliability_kind_t kind;
  double max_blocking_time;  // s: how long a write may wait for room
  static Reliability Reliable(double max_blocking_time) { return {DDS_RELIABILITY_RELIABLE, max_blocking_time}; }
  static Reliability BestEffort() { return {DDS_RELIABILITY_BEST_EFFORT, 0.0}; }
};

struct Durability {
  dds_durability_kind_t kind;
  static Durability Volatile() { return {DDS_DURABILITY_VOLATILE}; }
  static Durability TransientLocal() { return {DDS_DURABILITY_TRANSIENT_LOCAL}; }
};

struct History {
  dds_history_kind_t kind;
  std::int32_t depth;  // samples of each instance
  static History KeepLast(std::int32_t depth) { return {DDS_HISTORY_KEEP_LAST, depth}; }
  static History KeepAll() { return {DDS_HISTORY_KEEP_ALL, 0}; }
};

// The samples that a transient-local writer keeps for latecomers.
struct DurabilityService {
  History history;
};

// The time for which a sample is valid; then all caches drop it.
struct Lifespan {
  double seconds;
};

struct Liveliness {
  dds_liveliness_kind_t kind;
  double lease_duration;  // s: silent for longer means not alive
  static Liveliness Automatic(double lease_duration = kInfinite) { return {DDS_LIVELINESS_AUTOMATIC, lease_duration}; }
};

// The partition of publishers and subscribers. "*" in a name matches any text.
struct Partition {
  std::string name;
};

// Several of them. An endpoint in no partition is in "", which "*" matches.
struct Partitions {
  std::vector<std::string> names;
};

// Bytes that travel with the announcement of a participant, a reader or a writer.
struct UserData {
  std::string bytes;
};

// Whether deleting a writer disposes its instances.
struct WriterDataLifecycle {
  bool autodispose_unregistered_instances;
};

bool operator==(const class Qos& a, const class Qos& b);

// Whether a reader hears the writers of its own participant.
struct IgnoreLocal {
  dds_ignorelocal_kind_t kind;
  static IgnoreLocal Participant() { return {DDS_IGNORELOCAL_PARTICIPANT}; }
};

// A property of a participant, for the plugins of DDS Security.
struct Property {
  std::string name;
  std::string value;
};

class Qos {
 public:
  Qos();
  Qos(const Qos& other);
  Qos& operator=(const Qos& other);
  Qos(Qos&&) = default;
  Qos& operator=(Qos&&) = default;

  Qos& operator<<(const Reliability& policy);
  Qos& operator<<(const Durability& policy);
  Qos& operator<<(const History& policy);
  Qos& operator<<(const DurabilityService& policy);
  Qos& operator<<(const Lifespan& policy);
  Qos& operator<<(const Liveliness& policy);
  Qos& operator<<(const Partition& policy);
  Qos& operator<<(const Partitions& policy);
  Qos& operator<<(const WriterDataLifecycle& policy);
  Qos& operator<<(const IgnoreLocal& policy);
  Qos& operator<<(const UserData& policy);
  Qos& operator<<(const Property& property);

  const dds_qos_t* get() const { return qos_.get(); }

 private:
  struct Delete {
    void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
  };
  std::unique_ptr<dds_qos_t, Delete> qos_;
};

bool operator==(const Qos& a, const Qos& b);

}  // namespace troupe::dds
