// WholeSample: from any bytes to those of a whole sample. Almost all changes of a sample's bytes make it longer or
// shorter than its own fields say, and would never reach its converter.
#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <vector>

#include "fuzz/targets.h"
#include "transport/dds/binding/domain_participant.h"

namespace troupe::fuzz {

// The bytes, with zeros behind them as far as the sample needs them, up to its end. The bytes themselves if the sample
// would not be valid so either.
std::vector<std::byte> WholeSample(Bytes bytes, const dds_topic_descriptor_t& descriptor);

template <typename Wire>
std::vector<std::byte> WholeSample(Bytes bytes) {
  return WholeSample(bytes, *dds::TopicTraits<Wire>::descriptor());
}

}  // namespace troupe::fuzz
