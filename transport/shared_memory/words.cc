#include "transport/shared_memory/words.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace troupe {

void WordWriter::AddBytes(const void* bytes, std::size_t size) {
  Add(static_cast<std::uint64_t>(size));
  for (std::size_t i = 0; i < size; i += sizeof(Word)) {
    std::uint64_t value = 0;
    std::memcpy(&value, static_cast<const char*>(bytes) + i, std::min(sizeof(value), size - i));
    Add(value);
  }
}

bool WordReader::ReadFinite(double& value) {
  return Read(value) && std::isfinite(value);
}

bool WordReader::Read(bool& value) {
  std::uint64_t word = 0;
  if (!Read(word)) return false;
  value = word != 0;
  return word <= 1;
}

template <typename Bytes>
bool WordReader::ReadBytes(Bytes& bytes, std::size_t longest) {
  std::uint64_t size = 0;
  if (!Read(size) || size > longest || (size + sizeof(Word) - 1) / sizeof(Word) > remaining()) return false;
  bytes.resize(static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(Word)) {
    std::uint64_t value = 0;
    if (!Read(value)) return false;
    std::memcpy(bytes.data() + i, &value, std::min(sizeof(value), bytes.size() - i));
  }
  return true;
}

template bool WordReader::ReadBytes(std::string& bytes, std::size_t longest);
template bool WordReader::ReadBytes(std::vector<std::uint8_t>& bytes, std::size_t longest);

bool WordReader::ReadCount(std::size_t& count, std::size_t words) {
  std::uint64_t value = 0;
  if (!Read(value) || value > remaining() / words) return false;
  count = static_cast<std::size_t>(value);
  return true;
}

}  // namespace troupe
