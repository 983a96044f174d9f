// DataReader<T>: receives the values of one topic. Safe to use from several threads.
//
// The binding is a thin layer over Cyclone's C functions: types own handles, errors are exceptions (entity.h), names
// follow the C++ PSM of DDS. It knows nothing of Troupe; transport/dds/transport decides on QoS and topics.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/loaned_samples.h"
#include "transport/dds/binding/qos.h"

namespace troupe::dds {

template <typename T>
class DataReader {
 public:
  DataReader(const Subscriber& subscriber, const Topic<T>& topic, const Qos& qos)
      : entity_(Check(dds_create_reader(subscriber.handle(), topic.handle(), qos.get(), nullptr),
                      "creating a reader of topic '" + topic.name() + "'")) {}
  DataReader(DataReader&&) noexcept = default;
  DataReader& operator=(DataReader&&) noexcept = default;
  ~DataReader() { entity_.close(); }  // before the listener that it may be calling

  // At most LoanedSamples<T>::kMaxSamples samples; call again until it is empty. take() removes them from the reader,
  // read() leaves them there.
  LoanedSamples<T> take() { return Loan<T>(entity_.handle(), dds_take, "taking samples"); }
  LoanedSamples<T> read() { return Loan<T>(entity_.handle(), dds_read, "reading samples"); }

  // Replaces the contents of `buffer` by samples, which are removed from the reader. A full buffer: more may be
  // waiting.
  void take(SampleBuffer<T>& buffer) { buffer.FillFrom(entity_.handle()); }

  SubscriptionMatchedStatus subscription_matched_status() const {
    SubscriptionMatchedStatus status;
    Check(dds_get_subscription_matched_status(entity_.handle(), &status), "reading subscription_matched");
    return status;
  }
  LivelinessChangedStatus liveliness_changed_status() const {
    LivelinessChangedStatus status;
    Check(dds_get_liveliness_changed_status(entity_.handle(), &status), "reading liveliness_changed");
    return status;
  }
  RequestedIncompatibleQosStatus requested_incompatible_qos_status() const {
    RequestedIncompatibleQosStatus status;
    Check(dds_get_requested_incompatible_qos_status(entity_.handle(), &status), "reading requested_incompatible_qos");
    return status;
  }

  // Data that has arrived already is not announced again: call take() once after setting a listener.
  void set_listener(DataReaderListener listener) {
    auto next = std::make_unique<DataReaderListener>(std::move(listener));
    SetListener(entity_.handle(), *next);
    listener_ = std::move(next);
  }
  // No listener call runs any more when it returns.
  void clear_listener() noexcept { ClearListener(entity_.handle()); }

  dds_entity_t handle() const { return entity_.handle(); }

 private:
  std::unique_ptr<DataReaderListener> listener_;
  Entity entity_;
};

// Conditions, one or more of which a WaitSet waits for.

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

// WaitSet: waits until one of several conditions is true.
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

// The properties of another participant's writer, as discovered.

struct PublicationData {
  std::string topic_name;
  std::string type_name;
  std::vector<std::string> partitions;
  GuidPrefix participant;
  std::string user_data;  // bytes
};

// Nothing if the writer has ended. `publication` is a SampleInfo's publication_handle.
std::optional<PublicationData> MatchedPublicationData(dds_entity_t reader, dds_instance_handle_t publication);

// The participants of the readers that `writer` is matched with.
std::set<GuidPrefix> MatchedReaders(dds_entity_t writer);

// The handles of the writers that `reader` is matched with, ascending.
std::vector<dds_instance_handle_t> MatchedPublications(dds_entity_t reader);

}  // namespace troupe::dds
