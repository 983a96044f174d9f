// WaitSet: waits until one of several conditions is true.
#pragma once

#include <algorithm>
#include <vector>

#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/duration.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/exception.h"

namespace troupe::dds {

class WaitSet {
 public:
  explicit WaitSet(const DomainParticipant& participant)
      : entity_(Check(dds_create_waitset(participant.handle()), "creating a wait set")) {}

  // For conditions of any participants.
  WaitSet() : entity_(Check(dds_create_waitset(DDS_CYCLONEDDS_HANDLE), "creating a wait set")) {}

  // wait() returns `token` when the condition is true. REQUIRES: each condition has a token of its own.
  template <typename Condition>
  void attach(const Condition& condition, int token) {
    Check(dds_waitset_attach(entity_.handle(), condition.handle(), token), "attaching a condition");
    ++attached_;
  }
  template <typename Condition>
  void detach(const Condition& condition) {
    Check(dds_waitset_detach(entity_.handle(), condition.handle()), "detaching a condition");
    --attached_;
  }

  // The tokens of the conditions that are true; none when `seconds` went by first.
  std::vector<int> wait(double seconds) {
    std::vector<dds_attach_t> fired(attached_);
    const auto count = Check(dds_waitset_wait(entity_.handle(), fired.data(), fired.size(), ToDuration(seconds)),
                             "waiting for conditions");
    fired.resize(std::min(fired.size(), static_cast<std::size_t>(count)));
    return {fired.begin(), fired.end()};
  }

 private:
  Entity entity_;
  std::size_t attached_ = 0;
};

}  // namespace troupe::dds
