// BestEffortWriters: which of the writers that match a reader are not reliable. A writer may have left when its message
// is read, so each is noted when it is discovered.
#pragma once

#include <dds/dds.h>

#include <mutex>
#include <set>

namespace troupe::ros {

class BestEffortWriters {
 public:
  // REQUIRES: the reader exists while the other functions are called.
  explicit BestEffortWriters(dds_entity_t reader) : reader_(reader) {}

  // From any thread. `writer`: as in SubscriptionMatchedStatus; without effect if it is reliable, or has left.
  void Note(dds_instance_handle_t writer);
  bool Contains(dds_instance_handle_t writer);

 private:
  dds_entity_t reader_;
  std::mutex mutex_;
  std::set<dds_instance_handle_t> noted_;  // guarded by the mutex
};

}  // namespace troupe::ros
