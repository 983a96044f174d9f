#include "common/base/text.h"

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kMaxCharacter = 4;  // bytes

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U;
}

// U+0000 to U+001F and U+007F to U+009F. REQUIRES: a character of `length` bytes starts at `i`.
bool IsControl(std::string_view text, std::size_t i, std::size_t length) {
  const auto first = static_cast<unsigned char>(text[i]);
  if (length == 1) return first < 0x20 || first == 0x7f;
  return length == 2 && first == 0xc2 && static_cast<unsigned char>(text[i + 1]) < 0xa0;
}

constexpr std::string_view kDigits = "0123456789abcdef";

constexpr std::size_t kMaxLine = 2000;  // bytes, of a report: it may have texts of a peer, of any length

constexpr std::size_t kMaxName = 100;  // the time grows with the square; longer ones are not misspelt names

// The optimal string alignment distance, by rows.
std::size_t Distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

}  // namespace

// Unicode 15, table 3-7.
std::size_t Utf8Length(std::string_view text, std::size_t i) {
  const auto byte = [text](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0; };
  const auto continues = [byte](std::size_t at) { return byte(at) >= 0x80 && byte(at) <= 0xbf; };
  const int first = byte(i);
  const int second = byte(i + 1);
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4 || !continues(i + 1)) return 0;
  if (first < 0xe0) return 2;
  if (!continues(i + 2)) return 0;
  if (first < 0xf0) return (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ? 0 : 3;
  if (!continues(i + 3)) return 0;
  return (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f) ? 0 : 4;
}

std::size_t FindInvalidUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = Utf8Length(text, i);
    if (length == 0) return i;
    i += length;
  }
  return std::string_view::npos;
}

std::string_view CutUtf8(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && longest - end < kMaxCharacter && IsContinuation(text[end])) --end;
  // Bytes of which none begins a character are no UTF-8: they are cut anywhere.
  return text.substr(0, IsContinuation(text[end]) ? longest : end);
}

bool IsPlainLine(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = Utf8Length(text, i);
    if (length == 0 || IsControl(text, i, length)) return false;
    i += length;
  }
  return true;
}

std::string PlainLine(std::string_view text, std::size_t longest) {
  const std::string_view part = CutUtf8(text, longest);
  std::string line;
  line.reserve(part.size());
  for (std::size_t i = 0; i < part.size();) {
    const std::size_t length = Utf8Length(part, i);
    if (length == 0) {
      line += '?';
    } else if (IsControl(part, i, length)) {
      line += ' ';
    } else {
      line += part.substr(i, length);
    }
    i += std::max<std::size_t>(length, 1);
  }
  return line;
}

std::string ToHexadecimal(std::span<const std::byte> bytes) {
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::byte byte : bytes) {
    const auto value = std::to_integer<unsigned>(byte);
    text += kDigits[value >> 4];
    text += kDigits[value & 15];
  }
  return text;
}

std::optional<std::string> FromHexadecimal(std::string_view text) {
  if (text.size() % 2 != 0 || text.find_first_not_of(kDigits) != std::string_view::npos) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 2);
  for (std::size_t i = 0; i < text.size(); i += 2) {
    bytes += static_cast<char>(kDigits.find(text[i]) << 4 | kDigits.find(text[i + 1]));
  }
  return bytes;
}

std::optional<std::string> ClosestName(std::string_view found, const std::vector<std::string>& names) {
  if (found.size() > kMaxName) return std::nullopt;
  std::size_t least = kMaxName;
  std::optional<std::string> closest;
  for (const std::string& name : names) {
    if (name.size() > kMaxName) continue;
    const std::size_t distance = Distance(found, name);
    if (distance >= least || distance > std::max(found.size(), name.size()) / 3) continue;
    least = distance;
    closest = name;
  }
  return closest;
}

std::string DidYouMean(std::string_view found, const std::vector<std::string>& names) {
  const std::optional<std::string> closest = ClosestName(found, names);
  return closest ? "; did you mean '" + *closest + "'?" : "";
}

FloodLimiter::FloodLimiter(Tell tell) : tell_(std::move(tell)), second_began_(std::chrono::steady_clock::now()) {}

FloodLimiter::~FloodLimiter() {
  try {
    LogSuppressedCount();
  } catch (const std::exception&) {  // without memory the line is missing
  }
}

void FloodLimiter::Add(std::string_view line) noexcept {
  if (!tell_) return;
  const std::lock_guard lock(mutex_);
  try {
    const auto now = std::chrono::steady_clock::now();
    if (now - second_began_ >= std::chrono::seconds(1)) {
      second_began_ = now;
      reported_ = 0;
      LogSuppressedCount();
    }
    if (reported_ < kLinesInASecond) {
      tell_(PlainLine(line, kMaxLine));
      ++reported_;
      return;
    }
  } catch (const std::exception&) {  // as without memory
  }
  ++left_out_;
}

void FloodLimiter::LogSuppressedCount() {
  if (left_out_ == 0) return;
  tell_(std::to_string(left_out_) + " more lines like these");
  left_out_ = 0;
}

}  // namespace troupe
