// DataReader<T>: receives the values of one topic. Safe to use from several threads.
#pragma once

#include <memory>

#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/exception.h"
#include "transport/dds/binding/listener.h"
#include "transport/dds/binding/loaned_samples.h"
#include "transport/dds/binding/publisher.h"
#include "transport/dds/binding/qos.h"
#include "transport/dds/binding/sample_buffer.h"
#include "transport/dds/binding/status.h"
#include "transport/dds/binding/topic.h"

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

  // Data that arrived before is not announced again: call take() once after setting a listener.
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

}  // namespace troupe::dds
