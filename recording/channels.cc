#include "recording/channels.h"

#include "recording/idl_texts.h"
#include "troupe/check.h"

namespace troupe {

mcap::Schema SchemaOf(const ChannelType& channel) {
  for (std::size_t i = 0; i < kIdlTextCount; ++i) {
    if (std::string_view(kIdlTexts[i].file) != channel.file) continue;
    return {channel.type, "omgidl", kIdlTexts[i].text};
  }
  TROUPE_CHECK(false);  // the build embeds all of them
  return {};
}

}  // namespace troupe
