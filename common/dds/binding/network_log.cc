#include "common/dds/binding/network_log.h"

#include <dds/ddsrt/log.h>

#include <utility>

namespace troupe::dds {

NetworkLog::NetworkLog(Tell tell) : tell_(std::move(tell)), second_began_(std::chrono::steady_clock::now()) {
  dds_set_log_sink(
      [](void* self, const dds_log_data_t* entry) {
        std::string line(entry->message, entry->size);
        while (!line.empty() && line.back() == '\n') line.pop_back();
        static_cast<NetworkLog*>(self)->Add(line);
      },
      this);
}

NetworkLog::~NetworkLog() {
  dds_set_log_sink(nullptr, nullptr);  // waits for calls that have begun
  TellSum();
}

void NetworkLog::Add(const std::string& line) {
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - second_began_ >= std::chrono::seconds(1)) {
    TellSum();
    second_began_ = now;
    told_ = 0;
  }
  if (told_ == kLinesInASecond) {
    ++left_out_;
    return;
  }
  ++told_;
  tell_("network: " + line);
}

void NetworkLog::TellSum() {
  if (left_out_ > 0) tell_("network: " + std::to_string(std::exchange(left_out_, 0)) + " more lines like these");
}

}  // namespace troupe::dds
