#include "ros/connection/best_effort_writers.h"

namespace troupe::ros {
namespace {

constexpr std::size_t kMostNoted = 1000;  // a peer can make up any number

}  // namespace

void BestEffortWriters::Note(dds_instance_handle_t writer) {
  dds_builtintopic_endpoint_t* const endpoint = dds_get_matched_publication_data(reader_, writer);
  if (endpoint == nullptr) return;
  dds_reliability_kind_t kind = DDS_RELIABILITY_RELIABLE;
  dds_duration_t blocking = 0;
  const bool is_known = dds_qget_reliability(endpoint->qos, &kind, &blocking);
  dds_builtintopic_free_endpoint(endpoint);
  if (!is_known || kind != DDS_RELIABILITY_BEST_EFFORT) return;
  const std::lock_guard lock(mutex_);
  if (noted_.size() >= kMostNoted) noted_.clear();  // Contains asks again for those that are still there
  noted_.insert(writer);
}

bool BestEffortWriters::Contains(dds_instance_handle_t writer) {
  for (const bool asked : {false, true}) {
    if (asked) Note(writer);  // matched before the reader had a listener
    const std::lock_guard lock(mutex_);
    if (noted_.contains(writer)) return true;
  }
  return false;
}

}  // namespace troupe::ros
