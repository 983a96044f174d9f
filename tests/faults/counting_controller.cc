// A controller that decides by the number of its calls and the messages that it receives alone, so that a call or a
// message too many or too few in a run shows in its hashes. It sends its number of calls by its radio, if it has one.
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "troupe/controller.h"

namespace {

class CountingController final : public troupe::Controller {
 public:
  explicit CountingController(const troupe::RobotInfo& info) {
    for (std::size_t i = 0; i < info.sensors.size(); ++i) {
      if (std::holds_alternative<troupe::RadioParameters>(info.sensors[i].description->parameters)) radio_ = i;
    }
  }

  std::vector<std::size_t> Subscriptions() const override {
    return radio_ ? std::vector<std::size_t>{*radio_} : std::vector<std::size_t>{};
  }

  troupe::Command Update(const troupe::Observation& observation) override {
    ++calls_;
    troupe::Command command;
    command.twist.vx = 0.1 + 0.05 * static_cast<double>(calls_ % 7);
    command.twist.wz = calls_ % 3 == 0 ? 0.5 : -0.2;
    if (!radio_) return command;
    if (const auto* const reading = observation.sensors[*radio_].As<troupe::RadioReading>()) {
      for (const troupe::RadioReception& reception : reading->receptions) {
        heard_ += reception.bytes.front() + static_cast<unsigned>(reception.tick);
      }
    }
    command.twist.wz += 0.01 * static_cast<double>(heard_ % 11);
    command.messages.push_back({.radio = *radio_, .bytes = {static_cast<std::uint8_t>(calls_)}});
    return command;
  }
  std::unique_ptr<troupe::Controller> Clone() const override { return std::make_unique<CountingController>(*this); }

 private:
  std::optional<std::size_t> radio_;
  unsigned calls_ = 0;
  unsigned heard_ = 0;
};

}  // namespace

TROUPE_CONTROLLER(CountingController)
