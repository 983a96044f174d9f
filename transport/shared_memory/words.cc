#include "transport/shared_memory/words.h"

#include <algorithm>
#include <cstring>

namespace troupe {

void WordWriter::AddBytes(const void* bytes, std::size_t size) {
  AddWord(size);
  for (std::size_t i = 0; i < size; i += sizeof(Word)) {
    std::uint64_t value = 0;
    std::memcpy(&value, static_cast<const char*>(bytes) + i, std::min(sizeof(value), size - i));
    AddWord(value);
  }
}

template <typename Bytes>
bool WordReader::ReadBytes(Bytes& bytes) {
  std::uint64_t size = 0;
  if (!ReadWord(size) || size > remaining() * sizeof(Word)) return false;
  bytes.resize(static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(Word)) {
    std::uint64_t value = 0;
    if (!ReadWord(value)) return false;
    std::memcpy(bytes.data() + i, &value, std::min(sizeof(value), bytes.size() - i));
  }
  return true;
}

template bool WordReader::ReadBytes(std::string& bytes);
template bool WordReader::ReadBytes(std::vector<std::uint8_t>& bytes);

}  // namespace troupe
