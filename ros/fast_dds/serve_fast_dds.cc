#include "ros/fast_dds/serve_fast_dds.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <fastdds/dds/log/Log.hpp>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>

#include "common/base/text.h"
#include "ros/fast_dds/fast_service.h"
#include "ros/link/link.h"

namespace troupe::ros {
namespace {

using eprosima::fastdds::dds::Log;
using eprosima::fastdds::dds::LogConsumer;

// Calls that wait for the other process, in bytes; beyond them a client gets no response.
constexpr std::size_t kMaxPending = std::size_t{64} << 20;

// The errors of Fast DDS, as about messages of strangers.
class LimitedLog final : public LogConsumer {
 public:
  explicit LimitedLog(FloodLimiter& lines) : lines_(lines) {}
  void Consume(const Log::Entry& entry) override { lines_.Add(entry.message); }

 private:
  FloodLimiter& lines_;
};

class Services {
 public:
  Services(const RosNetwork& network, Link& link, const WakeEvent& wake, FloodLimiter& reports)
      : network_(network), link_(link), wake_(wake), reports_(reports) {}

  void Process(const LinkMessage& message) {
    switch (message.kind) {
      case LinkKind::kHello:
        std::memcpy(&guid_, message.content.data(), std::min(sizeof guid_, message.content.size()));
        return;
      case LinkKind::kMake:
        return Make(message.id, {reinterpret_cast<const char*>(message.content.data()), message.content.size()});
      case LinkKind::kRemove:
        return Remove(message.id);
      case LinkKind::kWrite:
        if (const auto found = services_.find(message.id); found != services_.end()) {
          found->second.service->Respond(
              {reinterpret_cast<const std::uint8_t*>(message.content.data()), message.content.size()});
        }
        return;
      default:
        return;
    }
  }

 private:
  struct Served {
    std::uint32_t domain = 0;
    std::unique_ptr<FastService> service;
  };
  struct Domain {
    std::unique_ptr<FastDomain> participant;
    std::size_t services = 0;
  };

  void Make(std::uint32_t id, std::string_view text) {
    const Result<MadeText> service = ParseMade(text);
    if (!service.ok()) return reports_.Add(service.error().message);
    Domain& domain = domains_[service.value().domain];
    try {
      if (!domain.participant) domain.participant = std::make_unique<FastDomain>(network_, service.value().domain);
      services_[id] = {service.value().domain,
                       std::make_unique<FastService>(
                           *domain.participant, service.value(), network_.distribution, guid_,
                           [this] { return ++last_call_; }, [this, id](const Bytes& request) { Pass(id, request); })};
      ++domain.services;
      const ServedContent served = services_[id].service->endpoints();
      link_.Add(LinkKind::kServed, id, std::as_bytes(std::span(&served, 1)));
    } catch (const std::runtime_error& error) {
      reports_.Add(error.what());
    }
  }

  void Remove(std::uint32_t id) {
    const auto found = services_.find(id);
    if (found == services_.end()) return;
    const auto domain = domains_.find(found->second.domain);
    services_.erase(found);
    if (--domain->second.services == 0) domains_.erase(domain);
  }

  // On a thread of Fast DDS.
  void Pass(std::uint32_t id, const Bytes& request) {
    if (request.size() > Link::kMaxContent || link_.pending() > kMaxPending) return;
    link_.Add(LinkKind::kSample, id, std::as_bytes(std::span(request)));
    if (!link_.Flush() || link_.pending() > 0) wake_.Signal();
  }

  const RosNetwork network_;
  Link& link_;
  const WakeEvent& wake_;
  FloodLimiter& reports_;
  std::uint64_t guid_ = 0;
  std::atomic<std::int64_t> last_call_ = 0;
  std::map<std::uint32_t, Domain> domains_;  // by number
  std::map<std::uint32_t, Served> services_;
};

}  // namespace

void ServeFastDds(const RosNetwork& network, int descriptor, const WakeEvent& stop) {
  FloodLimiter reports([](const std::string& text) { fmt::print(stderr, "ros-participant: warning: {}\n", text); });
  Log::ClearConsumers();
  Log::SetVerbosity(Log::Error);
  Log::RegisterConsumer(std::make_unique<LimitedLog>(reports));
  {
    Link link(descriptor);
    const WakeEvent wake;
    Services services(network, link, wake, reports);
    pollfd waited[] = {{stop.descriptor(), POLLIN, 0}, {wake.descriptor(), POLLIN, 0}, {descriptor, POLLIN, 0}};
    const auto receive = [&] { return link.Receive([&](const LinkMessage& message) { services.Process(message); }); };
    while (waited[0].revents == 0 && link.Flush() && receive()) {
      waited[2].events = link.pending() > 0 ? POLLIN | POLLOUT : POLLIN;
      poll(waited, 3, -1);
      wake.Clear();
    }
  }
  Log::ClearConsumers();  // they write to `reports`
}

}  // namespace troupe::ros
