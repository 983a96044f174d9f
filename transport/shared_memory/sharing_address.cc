#include "transport/shared_memory/sharing_address.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <fstream>

namespace troupe {
namespace {

// "pid:[4026531836]"; empty: unknown.
std::string Namespace(const char* kind) {
  std::array<char, 64> target{};
  const std::string path = std::string("/proc/self/ns/") + kind;
  const ssize_t size = readlink(path.c_str(), target.data(), target.size());
  return size > 0 ? std::string(target.data(), static_cast<std::size_t>(size)) : std::string();
}

template <typename Number>
bool ParseNumber(std::string_view text, Number& number, int base) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

// The text up to the next comma, which is removed from `rest`.
std::string_view NextField(std::string_view& rest) {
  const std::size_t end = rest.find(',');
  const std::string_view field = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return field;
}

}  // namespace

std::string ThisMachine() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string boot;
  const std::string processes = Namespace("pid");
  const std::string network = Namespace("net");
  if (!(file >> boot) || processes.empty() || network.empty()) return {};
  return fmt::format("{}/{}/{}/uid:{}", boot, processes, network, geteuid());
}

bool IsThisBoot(const SharingAddress& address) {
  const std::string here = ThisMachine();
  return !here.empty() && address.machine.starts_with(here.substr(0, here.find('/') + 1));
}

std::string ToText(const SharingAddress& address) {
  return fmt::format("{},{},{},{},{:x}", address.machine, address.process, address.frames, address.answers,
                     address.key);
}

std::optional<SharingAddress> ParseSharingAddress(std::string_view text) {
  SharingAddress address;
  address.machine = NextField(text);
  const bool valid = !address.machine.empty() && ParseNumber(NextField(text), address.process, 10) &&
                     ParseNumber(NextField(text), address.frames, 10) &&
                     ParseNumber(NextField(text), address.answers, 10) && ParseNumber(NextField(text), address.key, 16);
  if (!valid || !text.empty() || address.process <= 0 || address.frames < 0 || address.answers < 0) {
    return std::nullopt;
  }
  return address;
}

}  // namespace troupe
