// Text of users and peers: as UTF-8, as hexadecimal digits, the name that a user probably meant, and no flood of lines.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

// Text of users and peers as UTF-8: where its characters end, and what of it may be shown.

// The length in bytes of the character that starts at `i`, or 0 if there is none.
std::size_t Utf8Length(std::string_view text, std::size_t i);

// The offset of the first byte that is not valid UTF-8, or npos.
std::size_t FindInvalidUtf8(std::string_view text);

// The beginning of the text, of at most `longest` bytes, without a part of a character at its end.
std::string_view CutUtf8(std::string_view text, std::size_t longest);

// Whether the text is valid UTF-8 without control characters: on a terminal it is one line, and commands nothing.
bool IsPlainLine(std::string_view text);

// The text as a plain line, cut to at most `longest` bytes: control characters become spaces, and bytes that are not
// UTF-8 question marks.
std::string PlainLine(std::string_view text, std::size_t longest = std::string_view::npos);

std::string ToHexadecimal(std::span<const std::byte> bytes);

// The bytes; nothing if the text is not of such digits.
std::optional<std::string> FromHexadecimal(std::string_view text);

// ClosestName: the name that a user probably meant.

// Among the names that differ from `found` by few insertions, deletions, replacements or swaps of neighbouring
// characters (a third of the length of the longer one), the one that differs least; the first of several. Nothing if
// none is that close.
std::optional<std::string> ClosestName(std::string_view found, const std::vector<std::string>& names);

// The end of a message: "; did you mean 'speed'?", or "" without a close name.
std::string DidYouMean(std::string_view found, const std::vector<std::string>& names);

// FloodLimiter: passes the first kLinesInASecond lines of each second on, and a count of the others, so that a hostile
// peer cannot fill a disk with reports about itself. Safe to use from several threads.
class FloodLimiter {
 public:
  static constexpr int kLinesInASecond = 5;

  // Receives the lines, as plain lines, on any thread, one at a time.
  using Tell = std::function<void(const std::string& line)>;

  explicit FloodLimiter(Tell tell);  // empty: nothing is reported
  ~FloodLimiter();                   // reports the count of the lines left out since the last report
  FloodLimiter(const FloodLimiter&) = delete;
  FloodLimiter& operator=(const FloodLimiter&) = delete;

  // Never throws: without memory the line is missing.
  void Add(std::string_view line) noexcept;

 private:
  void LogSuppressedCount();

  const Tell tell_;
  std::mutex mutex_;  // guards the members below
  std::chrono::steady_clock::time_point second_began_;
  int reported_ = 0;  // lines since then
  std::uint64_t left_out_ = 0;
};

}  // namespace troupe
