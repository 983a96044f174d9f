#include "tests/faults/network.h"

#include <algorithm>
#include <utility>

namespace troupe::faults {
namespace {

// s. From the moment at which two processes can reach each other to their discovery.
constexpr double kMinDiscovery = 0.01;
constexpr double kMaxDiscovery = 0.2;

}  // namespace

void Network::AddAgent(ProcessId agent, Handlers at_agent, Handlers at_service) {
  Link& link = links_[agent];
  link.at_agent.handlers = std::move(at_agent);
  link.at_service.handlers = std::move(at_service);
  Update(kService, agent);
  Update(agent, kService);
}

bool Network::HasEnded(ProcessId process) const {
  const auto state = states_.find(process);
  return state != states_.end() && state->second == State::kEnded;
}

Network::View& Network::ViewOf(ProcessId from, ProcessId to) {
  return to == kService ? links_.at(from).at_service : links_.at(to).at_agent;
}

bool Network::IsOpen(ProcessId from, ProcessId to) const {
  return IsRunning(from) && !HasEnded(to) && ViewOf(from, to).blocked == 0;
}

void Network::Update(ProcessId from, ProcessId to) {
  View& view = ViewOf(from, to);
  const bool was_open = std::exchange(view.open, IsOpen(from, to));
  if (was_open == view.open) return;
  const std::uint64_t epoch = ++view.epoch;
  if (view.open) {
    const ProcessId agent = to == kService ? from : to;
    events_.After(random_.Uniform(kMinDiscovery, kMaxDiscovery), [this, agent] { Discover(agent); });
    if (view.connected) view.handlers.on_open();
    return;
  }
  events_.After(lease_ * random_.Uniform(1.0, 1.1), [this, from, to, epoch] {
    View& closed = ViewOf(from, to);
    if (closed.epoch != epoch || !closed.connected) return;
    closed.connected = false;
    RunInside(to, closed.handlers.on_lost);
  });
}

void Network::UpdateAll(ProcessId process) {
  for (auto& [agent, link] : links_) {
    if (process != kService && agent != process) continue;
    if (process == kService) Update(kService, agent);
    if (process != kService) Update(agent, kService);
  }
}

void Network::Discover(ProcessId agent) {
  if (!IsOpen(kService, agent) || !IsOpen(agent, kService)) return;
  Link& link = links_.at(agent);
  if (!link.at_agent.connected) {
    link.at_agent.connected = true;
    link.at_agent.handlers.on_discovered();
  }
  if (!link.at_service.connected) {
    link.at_service.connected = true;
    link.at_service.handlers.on_discovered();
  }
}

void Network::Stop(ProcessId process) {
  if (!IsRunning(process)) return;
  states_[process] = State::kStopped;
  stopped_at_[process] = events_.now();
  UpdateAll(process);
}

void Network::Continue(ProcessId process) {
  if (IsRunning(process) || HasEnded(process)) return;
  states_.erase(process);
  UpdateAll(process);
  if (events_.now() - stopped_at_[process] > lease_) ExpireLeasesOf(process);
  std::vector<std::function<void()>> calls;
  if (const auto waiting = waiting_.find(process); waiting != waiting_.end()) calls.swap(waiting->second);
  for (const std::function<void()>& call : calls) RunInside(process, call);
}

void Network::ExpireLeasesOf(ProcessId process) {
  // Its own leases may expire before it has read the messages that are waiting.
  for (auto& [agent, link] : links_) {
    if (process != kService && agent != process) continue;
    View& view = process == kService ? link.at_service : link.at_agent;
    if (!view.connected || !random_.Chance(0.3)) continue;
    view.connected = false;
    view.handlers.on_lost();
    events_.After(random_.Uniform(kMinDiscovery, kMaxDiscovery), [this, lost = agent] { Discover(lost); });
  }
}

void Network::Kill(ProcessId process) {
  if (HasEnded(process)) return;
  states_[process] = State::kEnded;
  waiting_.erase(process);
  UpdateAll(process);
}

void Network::ReplaceService() {
  states_.erase(kService);
  for (auto& [agent, link] : links_) {
    for (View* view : {&link.at_agent, &link.at_service}) ++view->epoch;
    link.at_service.connected = link.at_service.open = link.at_agent.open = false;
    if (!std::exchange(link.at_agent.connected, false)) continue;
    if (random_.Chance(0.5)) {
      RunInside(agent, link.at_agent.handlers.on_lost);
    } else {
      events_.After(lease_, [this, agent = agent] {
        const View& view = links_.at(agent).at_agent;
        if (!view.connected) RunInside(agent, view.handlers.on_lost);
      });
    }
  }
  UpdateAll(kService);
  for (const auto& [agent, link] : links_) Update(agent, kService);
}

void Network::End(ProcessId process) {
  if (HasEnded(process)) return;
  for (auto& [agent, link] : links_) {
    if (process != kService && agent != process) continue;
    const ProcessId other = process == kService ? agent : kService;
    View& view = ViewOf(process, other);
    if (!view.connected || !IsOpen(process, other)) continue;
    view.connected = false;
    const double at = std::max(view.in_order_at, events_.now() + faults_.most_delay);
    events_.At(at, [this, other, ended = view.handlers.on_ended] { RunInside(other, ended); });
  }
  Kill(process);
}

void Network::BlockToAgent(ProcessId agent, bool blocked) {
  links_.at(agent).at_agent.blocked += blocked ? 1 : -1;
  Update(kService, agent);
}

void Network::BlockFromAgent(ProcessId agent, bool blocked) {
  links_.at(agent).at_service.blocked += blocked ? 1 : -1;
  Update(agent, kService);
}

void Network::RunInside(ProcessId process, std::function<void()> call) {
  if (HasEnded(process)) return;
  if (IsRunning(process)) return call();
  std::vector<std::function<void()>>& waiting = waiting_[process];
  waiting.push_back(std::move(call));
  most_waiting_ = std::max(most_waiting_, waiting.size());
}

void Network::Deliver(ProcessId from, ProcessId to, double delay, const std::function<void()>& receive) {
  events_.After(delay, [this, from, to, receive] {
    if (ViewOf(from, to).connected) RunInside(to, receive);
  });
}

void Network::Send(ProcessId from, ProcessId to, const std::function<void()>& receive) {
  const bool connected = ViewOf(from, to).connected && ViewOf(to, from).connected;
  if (!connected || !IsOpen(from, to) || random_.Chance(faults_.loss)) return;
  const int copies = random_.Chance(faults_.duplicate) ? 2 : 1;
  for (int i = 0; i < copies; ++i) {
    double delay = random_.Uniform(faults_.least_delay, faults_.most_delay);
    if (random_.Chance(faults_.reorder)) delay += random_.Uniform(0.0, random_.Chance(0.1) ? 3.0 : 0.2);
    Deliver(from, to, delay, receive);
  }
}

void Network::SendWithPresence(ProcessId from, ProcessId to, const std::function<void()>& receive) {
  Send(from, to, IfConnected(from, to, receive));
}

std::function<void()> Network::IfConnected(ProcessId from, ProcessId to, const std::function<void()>& receive) {
  return [this, from, to, receive] {
    if (ViewOf(from, to).connected) receive();
  };
}

bool Network::SendIntact(ProcessId from, ProcessId to, const std::function<void()>& receive) {
  View& view = ViewOf(from, to);
  if (!view.connected || !IsOpen(from, to)) return false;
  const double delay = random_.Uniform(faults_.least_delay, faults_.most_delay);
  view.in_order_at = std::max(view.in_order_at, events_.now() + delay);
  Deliver(from, to, view.in_order_at - events_.now(), IfConnected(from, to, receive));
  return true;
}

}  // namespace troupe::faults
