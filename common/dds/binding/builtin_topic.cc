#include "common/dds/binding/builtin_topic.h"

#include <algorithm>

#include "common/dds/binding/exception.h"

namespace troupe::dds {

std::optional<PublicationData> MatchedPublicationData(dds_entity_t reader, dds_instance_handle_t publication) {
  dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, publication);
  if (endpoint == nullptr) return std::nullopt;
  PublicationData data{endpoint->topic_name, endpoint->type_name, {}, PrefixOf(endpoint->participant_key)};
  std::uint32_t count = 0;
  char** names = nullptr;
  if (dds_qget_partition(endpoint->qos, &count, &names)) {
    for (std::uint32_t i = 0; i < count; ++i) {
      data.partitions.emplace_back(names[i]);
      dds_free(names[i]);
    }
    dds_free(names);
  }
  dds_builtintopic_free_endpoint(endpoint);
  return data;
}

std::vector<dds_instance_handle_t> MatchedPublications(dds_entity_t reader) {
  std::vector<dds_instance_handle_t> handles(16);
  for (;;) {
    const auto count = static_cast<std::size_t>(
        Check(dds_get_matched_publications(reader, handles.data(), handles.size()), "reading the matched writers"));
    const bool complete = count <= handles.size();
    handles.resize(count);
    if (!complete) continue;
    std::sort(handles.begin(), handles.end());
    return handles;
  }
}

}  // namespace troupe::dds
