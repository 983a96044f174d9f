// Listeners: functions that Cyclone calls on a thread of its own when a status has changed. Inside one, write() and
// take() are allowed; creating or deleting entities is not.
//
// An exception never reaches Cyclone, which is C: it is passed to on_exception, or printed on standard error if that is
// empty.
#pragma once

#include <dds/dds.h>

#include <exception>
#include <functional>

#include "transport/dds/binding/status.h"

namespace troupe::dds {

struct DataReaderListener {
  std::function<void()> on_data_available;
  std::function<void(const SubscriptionMatchedStatus&)> on_subscription_matched;
  std::function<void(const LivelinessChangedStatus&)> on_liveliness_changed;
  std::function<void(const RequestedIncompatibleQosStatus&)> on_requested_incompatible_qos;
  std::function<void(std::exception_ptr)> on_exception;
};

struct DataWriterListener {
  std::function<void(const PublicationMatchedStatus&)> on_publication_matched;
  std::function<void(const OfferedIncompatibleQosStatus&)> on_offered_incompatible_qos;
  std::function<void(std::exception_ptr)> on_exception;
};

// Make `entity` (a reader, a writer) call `listener`, which must outlive it or the next call for the same entity.
void SetListener(dds_entity_t entity, const DataReaderListener& listener);
void SetListener(dds_entity_t entity, const DataWriterListener& listener);

// No listener call runs any more when it returns. Never call it from a listener of the same entity.
void ClearListener(dds_entity_t entity) noexcept;

}  // namespace troupe::dds
