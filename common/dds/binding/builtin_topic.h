// The properties of another participant's writer, as discovered.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/dds/binding/data_reader.h"

namespace troupe::dds {

struct PublicationData {
  std::string topic_name;
  std::string type_name;
  std::vector<std::string> partitions;
};

// Nothing if the writer has ended. `publication` is a SampleInfo's publication_handle. Not to be called from a
// listener.
std::optional<PublicationData> MatchedPublicationData(dds_entity_t reader, dds_instance_handle_t publication);

}  // namespace troupe::dds
