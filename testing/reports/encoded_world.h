// EncodedWorld: a world in a line of a report, so that the report of shards is drawn where the files of their scenario
// are not: its CDR bytes (transport/wire), compressed by zstd, in Base64.
//
// Equal worlds give equal texts with one version of zstd. Any thread.
#pragma once

#include <cstdint>
#include <string>

#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

struct EncodedWorld {
  std::uint64_t bytes = 0;  // before compression
  std::string zstd;         // in Base64

  bool operator==(const EncodedWorld&) const = default;
};

EncodedWorld Encode(const WorldDescription& world);
// Any text is safe. The error: one that is no world.
Result<WorldDescription> Decode(const EncodedWorld& encoded);

}  // namespace troupe
