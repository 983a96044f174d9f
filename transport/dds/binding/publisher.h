// Publisher and Subscriber: give writers and readers their partition.
#pragma once

#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/exception.h"
#include "transport/dds/binding/qos.h"

namespace troupe::dds {

class Publisher {
 public:
  explicit Publisher(const DomainParticipant& participant, const Qos& qos = Qos())
      : entity_(Check(dds_create_publisher(participant.handle(), qos.get(), nullptr), "creating a publisher")) {}
  dds_entity_t handle() const { return entity_.handle(); }

 private:
  Entity entity_;
};

class Subscriber {
 public:
  explicit Subscriber(const DomainParticipant& participant, const Qos& qos = Qos())
      : entity_(Check(dds_create_subscriber(participant.handle(), qos.get(), nullptr), "creating a subscriber")) {}
  dds_entity_t handle() const { return entity_.handle(); }

 private:
  Entity entity_;
};

}  // namespace troupe::dds
