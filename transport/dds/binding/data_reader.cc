#include "transport/dds/binding/data_reader.h"

namespace troupe::dds {
namespace {

// `list` is a function of Cyclone's that lists matches. Ascending.
template <typename List>
std::vector<dds_instance_handle_t> AllHandles(List list, dds_entity_t entity) {
  std::vector<dds_instance_handle_t> handles(16);
  for (;;) {
    const auto count =
        static_cast<std::size_t>(Check(list(entity, handles.data(), handles.size()), "reading the matches"));
    const bool complete = count <= handles.size();
    handles.resize(count);
    if (!complete) continue;
    std::sort(handles.begin(), handles.end());
    return handles;
  }
}

}  // namespace

std::optional<PublicationData> MatchedPublicationData(dds_entity_t reader, dds_instance_handle_t publication) {
  dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, publication);
  if (endpoint == nullptr) return std::nullopt;
  PublicationData data{endpoint->topic_name, endpoint->type_name, {}, PrefixOf(endpoint->participant_key), {}};
  std::uint32_t count = 0;
  char** names = nullptr;
  if (dds_qget_partition(endpoint->qos, &count, &names)) {
    for (std::uint32_t i = 0; i < count; ++i) {
      data.partitions.emplace_back(names[i]);
      dds_free(names[i]);
    }
    dds_free(names);
  }
  void* user_data = nullptr;
  std::size_t size = 0;
  if (dds_qget_userdata(endpoint->qos, &user_data, &size) && size > 0) {
    data.user_data.assign(static_cast<const char*>(user_data), size);
    dds_free(user_data);
  }
  dds_builtintopic_free_endpoint(endpoint);
  return data;
}

std::vector<dds_instance_handle_t> MatchedPublications(dds_entity_t reader) {
  return AllHandles(dds_get_matched_publications, reader);
}

std::set<GuidPrefix> MatchedReaders(dds_entity_t writer) {
  std::set<GuidPrefix> participants;
  for (const dds_instance_handle_t reader : AllHandles(dds_get_matched_subscriptions, writer)) {
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_subscription_data(writer, reader);
    if (endpoint == nullptr) continue;
    participants.insert(PrefixOf(endpoint->participant_key));
    dds_builtintopic_free_endpoint(endpoint);
  }
  return participants;
}

}  // namespace troupe::dds
