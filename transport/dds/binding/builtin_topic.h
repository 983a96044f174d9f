// The properties of another participant's writer, as discovered.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/guid_prefix.h"

namespace troupe::dds {

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
