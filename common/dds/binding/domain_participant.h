// DomainParticipant: a process' presence in a DDS domain, with a configuration of its own.
#pragma once

#include "common/dds/binding/domain_config.h"
#include "common/dds/binding/entity.h"
#include "common/dds/binding/guid_prefix.h"
#include "common/dds/binding/qos.h"

namespace troupe::dds {

class DomainParticipant {
 public:
  // Throws Exception: no such network interface, ports in use, out of resources, unreadable keys.
  explicit DomainParticipant(const DomainConfig& config, const Qos& qos = Qos());

  GuidPrefix guid_prefix() const;
  dds_entity_t handle() const { return participant_.handle(); }

 private:
  Entity domain_;  // Cyclone's threads and sockets; ends after the participant
  Entity participant_;
};

}  // namespace troupe::dds
