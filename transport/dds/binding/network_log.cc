#include "transport/dds/binding/network_log.h"

#include <dds/ddsrt/log.h>

#include <atomic>
#include <cstdio>
#include <string_view>
#include <utility>

namespace troupe::dds {
namespace {

std::atomic<bool> leaves_out_early_participants = false;

bool IsOfEarlyParticipant(std::string_view line) {
  return leaves_out_early_participants && line.starts_with("Remote secure participant ") &&
         line.ends_with(" not allowed");
}

}  // namespace

NetworkLog::NetworkLog(FloodLimiter::Tell tell)
    : lines_([tell = std::move(tell)](const std::string& line) { tell("network: " + line); }) {
  dds_set_log_sink(
      [](void* lines, const dds_log_data_t* entry) {
        std::string_view line(entry->message, entry->size);
        while (!line.empty() && line.back() == '\n') line.remove_suffix(1);
        if (!IsOfEarlyParticipant(line)) static_cast<FloodLimiter*>(lines)->Add(line);
      },
      &lines_);
}

NetworkLog::~NetworkLog() {
  dds_set_log_sink(nullptr, nullptr);  // waits for calls that have begun
}

void LeaveOutEarlyParticipants() {
  leaves_out_early_participants = true;
}

void PrintFirstNetworkMessage() {
  static const NetworkLog log([printed = false](const std::string& line) mutable {
    if (!std::exchange(printed, true)) std::fprintf(stderr, "%s (further ones are not shown)\n", line.c_str());
  });
}

}  // namespace troupe::dds
