// DomainParticipant: a process' presence in a DDS domain, with a configuration of its own.
#pragma once

#include <cstdint>
#include <memory>

#include "transport/dds/binding/domain_config.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/guid_prefix.h"
#include "transport/dds/binding/qos.h"

namespace troupe::dds {

// Cyclone's threads and sockets, and the number by which the process knows the domain.
struct SharedDomain {
  std::shared_ptr<const Entity> entity;
  std::uint32_t number = 0;
};

class DomainParticipant {
 public:
  // Throws Exception: no such network interface, ports in use, out of resources, unreadable keys.
  explicit DomainParticipant(const DomainConfig& config, const Qos& qos = Qos());

  GuidPrefix guid_prefix() const;
  bool describes_types() const { return describes_types_; }
  dds_entity_t handle() const { return participant_.handle(); }

 private:
  SharedDomain domain_;  // ends after the participant
  Entity participant_;
  const bool describes_types_;
};

}  // namespace troupe::dds
