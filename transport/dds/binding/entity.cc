#include "transport/dds/binding/entity.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <span>

#include "common/base/text.h"

namespace troupe::dds {
namespace {

void Report(const std::exception_ptr& exception, const std::function<void(std::exception_ptr)>& on_exception) noexcept {
  try {
    if (on_exception) {
      on_exception(exception);
      return;
    }
    std::rethrow_exception(exception);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "DDS listener: %s\n", error.what());
  } catch (...) {
    std::fprintf(stderr, "DDS listener: an exception of an unknown type\n");
  }
}

// Calls the member of the listener behind `argument`, if it is set.
template <typename Listener, typename Member, typename... Status>
void Call(void* argument, Member member, const Status&... status) noexcept {
  const auto& listener = *static_cast<const Listener*>(argument);
  const auto& function = listener.*member;
  if (!function) return;
  try {
    function(status...);
  } catch (...) {
    Report(std::current_exception(), listener.on_exception);
  }
}

extern "C" {

void OnDataAvailable(dds_entity_t, void* argument) {
  Call<DataReaderListener>(argument, &DataReaderListener::on_data_available);
}
void OnSubscriptionMatched(dds_entity_t, const dds_subscription_matched_status_t status, void* argument) {
  Call<DataReaderListener>(argument, &DataReaderListener::on_subscription_matched, status);
}
void OnLivelinessChanged(dds_entity_t, const dds_liveliness_changed_status_t status, void* argument) {
  Call<DataReaderListener>(argument, &DataReaderListener::on_liveliness_changed, status);
}
void OnRequestedIncompatibleQos(dds_entity_t, const dds_requested_incompatible_qos_status_t status, void* argument) {
  Call<DataReaderListener>(argument, &DataReaderListener::on_requested_incompatible_qos, status);
}
void OnPublicationMatched(dds_entity_t, const dds_publication_matched_status_t status, void* argument) {
  Call<DataWriterListener>(argument, &DataWriterListener::on_publication_matched, status);
}
void OnOfferedIncompatibleQos(dds_entity_t, const dds_offered_incompatible_qos_status_t status, void* argument) {
  Call<DataWriterListener>(argument, &DataWriterListener::on_offered_incompatible_qos, status);
}

}  // extern "C"

struct Delete {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using ListenerHandle = std::unique_ptr<dds_listener_t, Delete>;

}  // namespace

Exception::Exception(dds_return_t code, const std::string& doing)
    : std::runtime_error("DDS: " + std::string(dds_strretcode(code)) + " while " + doing), code_(code) {}

GuidPrefix PrefixOf(const dds_guid_t& guid) {
  GuidPrefix prefix;
  std::copy_n(std::begin(guid.v), prefix.bytes.size(), prefix.bytes.begin());
  return prefix;
}

std::string ToText(const GuidPrefix& prefix) {
  return ToHexadecimal(std::as_bytes(std::span(prefix.bytes)));
}

std::optional<GuidPrefix> ParseGuidPrefix(std::string_view text) {
  const std::optional<std::string> bytes = FromHexadecimal(text);
  GuidPrefix prefix;
  if (!bytes || bytes->size() != prefix.bytes.size()) return std::nullopt;
  std::copy(bytes->begin(), bytes->end(), prefix.bytes.begin());
  return prefix;
}

void SetListener(dds_entity_t entity, const DataReaderListener& listener) {
  ListenerHandle handle(dds_create_listener(const_cast<DataReaderListener*>(&listener)));
  // Only the statuses with a function: Cyclone calls the listener for each change of a status that it has.
  if (listener.on_data_available) dds_lset_data_available(handle.get(), OnDataAvailable);
  if (listener.on_subscription_matched) dds_lset_subscription_matched(handle.get(), OnSubscriptionMatched);
  if (listener.on_liveliness_changed) dds_lset_liveliness_changed(handle.get(), OnLivelinessChanged);
  if (listener.on_requested_incompatible_qos) {
    dds_lset_requested_incompatible_qos(handle.get(), OnRequestedIncompatibleQos);
  }
  Check(dds_set_listener(entity, handle.get()), "setting a reader's listener");
}

void SetListener(dds_entity_t entity, const DataWriterListener& listener) {
  ListenerHandle handle(dds_create_listener(const_cast<DataWriterListener*>(&listener)));
  if (listener.on_publication_matched) dds_lset_publication_matched(handle.get(), OnPublicationMatched);
  if (listener.on_offered_incompatible_qos) dds_lset_offered_incompatible_qos(handle.get(), OnOfferedIncompatibleQos);
  Check(dds_set_listener(entity, handle.get()), "setting a writer's listener");
}

void ClearListener(dds_entity_t entity) noexcept {
  dds_set_listener(entity, nullptr);
}

}  // namespace troupe::dds
