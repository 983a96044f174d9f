#include "testing/reports/encoded_world.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/base64.h"
#include "recording/mcap/bytes.h"
#include "transport/protocol/messages.h"
#include "transport/wire/message_bytes.h"

namespace troupe {

// As the session of a run has it: the only message with a world alone.
EncodedWorld Encode(const WorldDescription& world) {
  SessionMessage session;
  session.world = world;
  const std::vector<std::byte> bytes = wire::ToBytes(session);
  std::vector<std::byte> compressed;
  mcap::Compressor().Compress(bytes, compressed);
  return {bytes.size(), Base64({reinterpret_cast<const char*>(compressed.data()), compressed.size()})};
}

Result<WorldDescription> Decode(const EncodedWorld& encoded) {
  const Error none = BadInput("found no world of a report");
  const std::optional<std::string> compressed = FromBase64(encoded.zstd);
  if (!compressed) return none;
  const Result<std::vector<std::byte>> bytes = mcap::Decompress(std::as_bytes(std::span(*compressed)), encoded.bytes);
  if (!bytes.ok()) return none;
  const Result<SessionMessage> session = wire::FromBytes<SessionMessage>(bytes.value());
  if (!session.ok()) return none;
  return *session.value().world;
}

}  // namespace troupe
