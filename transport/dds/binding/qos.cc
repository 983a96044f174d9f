#include "transport/dds/binding/qos.h"

namespace troupe::dds {

Qos::Qos() : qos_(dds_create_qos()) {}

Qos::Qos(const Qos& other) : Qos() {
  dds_copy_qos(qos_.get(), other.qos_.get());
}

Qos& Qos::operator=(const Qos& other) {
  if (this != &other) *this = Qos(other);
  return *this;
}

Qos& Qos::operator<<(const Reliability& policy) {
  dds_qset_reliability(qos_.get(), policy.kind, ToDuration(policy.max_blocking_time));
  return *this;
}

Qos& Qos::operator<<(const Durability& policy) {
  dds_qset_durability(qos_.get(), policy.kind);
  return *this;
}

Qos& Qos::operator<<(const History& policy) {
  dds_qset_history(qos_.get(), policy.kind, policy.depth);
  return *this;
}

Qos& Qos::operator<<(const DurabilityService& policy) {
  dds_qset_durability_service(qos_.get(), 0, policy.history.kind, policy.history.depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  return *this;
}

Qos& Qos::operator<<(const Lifespan& policy) {
  dds_qset_lifespan(qos_.get(), ToDuration(policy.seconds));
  return *this;
}

Qos& Qos::operator<<(const Liveliness& policy) {
  dds_qset_liveliness(qos_.get(), policy.kind, ToDuration(policy.lease_duration));
  return *this;
}

Qos& Qos::operator<<(const Partition& policy) {
  dds_qset_partition1(qos_.get(), policy.name.c_str());
  return *this;
}

Qos& Qos::operator<<(const Partitions& policy) {
  std::vector<const char*> names;
  for (const std::string& name : policy.names) names.push_back(name.c_str());
  dds_qset_partition(qos_.get(), static_cast<std::uint32_t>(names.size()), names.data());
  return *this;
}

Qos& Qos::operator<<(const WriterDataLifecycle& policy) {
  dds_qset_writer_data_lifecycle(qos_.get(), policy.autodispose_unregistered_instances);
  return *this;
}

Qos& Qos::operator<<(const IgnoreLocal& policy) {
  dds_qset_ignorelocal(qos_.get(), policy.kind);
  return *this;
}

Qos& Qos::operator<<(const UserData& policy) {
  dds_qset_userdata(qos_.get(), policy.bytes.data(), policy.bytes.size());
  return *this;
}

Qos& Qos::operator<<(const Property& property) {
  dds_qset_prop(qos_.get(), property.name.c_str(), property.value.c_str());
  return *this;
}

bool operator==(const Qos& a, const Qos& b) {
  return dds_qos_equal(a.get(), b.get());
}

}  // namespace troupe::dds
