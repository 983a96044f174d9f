// DataWriter<T>: publishes values of one topic. Safe to use from several threads.
//
// A sample is copied into Cyclone's caches by write: its memory may be used again at once. A writer that ends waits as
// DomainConfig::linger_seconds says.
#pragma once

#include <memory>

#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/qos.h"

namespace troupe::dds {

template <typename T>
class DataWriter {
 public:
  DataWriter(const Publisher& publisher, const Topic<T>& topic, const Qos& qos)
      : entity_(Check(dds_create_writer(publisher.handle(), topic.handle(), qos.get(), nullptr),
                      "creating a writer of topic '" + topic.name() + "'")) {}
  DataWriter(DataWriter&&) noexcept = default;
  DataWriter& operator=(DataWriter&&) noexcept = default;
  ~DataWriter() { entity_.close(); }  // before the listener that it may be calling

  // Throws Exception with DDS_RETCODE_TIMEOUT when there was no room within max_blocking_time.
  void write(const T& sample) { Check(dds_write(entity_.handle(), &sample), "writing a sample"); }
  // Ends the instance that has the key of `sample`.
  void dispose(const T& sample) { Check(dds_dispose(entity_.handle(), &sample), "disposing an instance"); }
  // True if all matched reliable readers have acknowledged everything within `seconds`.
  bool wait_for_acknowledgments(double seconds) {
    const dds_return_t result = dds_wait_for_acks(entity_.handle(), ToDuration(seconds));
    if (result == DDS_RETCODE_TIMEOUT) return false;
    Check(result, "waiting for acknowledgments");
    return true;
  }

  PublicationMatchedStatus publication_matched_status() const {
    PublicationMatchedStatus status;
    Check(dds_get_publication_matched_status(entity_.handle(), &status), "reading publication_matched");
    return status;
  }
  OfferedIncompatibleQosStatus offered_incompatible_qos_status() const {
    OfferedIncompatibleQosStatus status;
    Check(dds_get_offered_incompatible_qos_status(entity_.handle(), &status), "reading offered_incompatible_qos");
    return status;
  }

  void set_listener(DataWriterListener listener) {
    auto next = std::make_unique<DataWriterListener>(std::move(listener));
    SetListener(entity_.handle(), *next);
    listener_ = std::move(next);
  }
  void clear_listener() noexcept { ClearListener(entity_.handle()); }

  dds_entity_t handle() const { return entity_.handle(); }

 private:
  std::unique_ptr<DataWriterListener> listener_;
  Entity entity_;
};

}  // namespace troupe::dds
