#include "common/sharing/words.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace troupe {

void WordWriter::Add(const std::string& text) {
  Add(static_cast<std::uint64_t>(text.size()));
  for (std::size_t i = 0; i < text.size(); i += sizeof(Word)) {
    std::uint64_t value = 0;
    std::memcpy(&value, text.data() + i, std::min(sizeof(value), text.size() - i));
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

bool WordReader::Read(std::string& text, std::size_t longest) {
  std::uint64_t size = 0;
  if (!Read(size) || size > longest || (size + sizeof(Word) - 1) / sizeof(Word) > remaining()) return false;
  text.resize(static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < text.size(); i += sizeof(Word)) {
    std::uint64_t value = 0;
    if (!Read(value)) return false;
    std::memcpy(text.data() + i, &value, std::min(sizeof(value), text.size() - i));
  }
  return true;
}

bool WordReader::ReadCount(std::size_t& count, std::size_t words) {
  std::uint64_t value = 0;
  if (!Read(value) || value > remaining() / words) return false;
  count = static_cast<std::size_t>(value);
  return true;
}

}  // namespace troupe
