#include "transport/dds/binding/wire.h"

#include <cstring>

namespace troupe::dds {

char* WireArena::Copy(std::string_view text) {
  char* copy = static_cast<char*>(memory_.allocate(text.size() + 1, 1));
  if (!text.empty()) std::memcpy(copy, text.data(), text.size());
  copy[text.size()] = '\0';
  return copy;
}

}  // namespace troupe::dds
