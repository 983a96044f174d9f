// Conditions, one or more of which a WaitSet waits for.
#pragma once

#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/exception.h"

namespace troupe::dds {

// True while the reader has samples that were not read.
class ReadCondition {
 public:
  template <typename T>
  explicit ReadCondition(const DataReader<T>& reader)
      : entity_(Check(dds_create_readcondition(reader.handle(),
                                               DDS_NOT_READ_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ANY_INSTANCE_STATE),
                      "creating a read condition")) {}
  dds_entity_t handle() const { return entity_.handle(); }

 private:
  Entity entity_;
};

// Set and cleared by the program, to wake a waiting thread.
class GuardCondition {
 public:
  explicit GuardCondition(const DomainParticipant& participant)
      : entity_(Check(dds_create_guardcondition(participant.handle()), "creating a guard condition")) {}
  void trigger_value(bool value) {
    Check(dds_set_guardcondition(entity_.handle(), value), "setting a guard condition");
  }
  bool trigger_value() const {
    bool value = false;
    Check(dds_read_guardcondition(entity_.handle(), &value), "reading a guard condition");
    return value;
  }
  dds_entity_t handle() const { return entity_.handle(); }

 private:
  Entity entity_;
};

}  // namespace troupe::dds
