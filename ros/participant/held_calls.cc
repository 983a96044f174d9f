#include "ros/participant/held_calls.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "ros/participant/agent_endpoints.h"

namespace troupe::ros {
namespace {

// "/robots/driver/get_parameters" is a service of the node "driver".
std::string NodeOf(const std::string& parameter_service) {
  const std::size_t end = parameter_service.rfind('/');
  const std::size_t begin = end == 0 ? std::string::npos : parameter_service.rfind('/', end - 1);
  return begin == std::string::npos ? std::string() : parameter_service.substr(begin + 1, end - begin - 1);
}

// A watch as users name it: "/r0/cmd_vel" for "rt/r0/cmd_vel".
std::string TextOf(const std::string& watched) {
  return TopicWatch::IsNode(watched) ? watched : watched.substr(watched.find('/'));
}

}  // namespace

void HeldCalls::Add(Call call) {
  const std::lock_guard lock(mutex_);
  arrived_.push_back(std::move(call));
}

std::vector<HeldCalls::Call> HeldCalls::Take(const AgentEndpoints& agent, std::uint32_t service) {
  std::vector<Call> taken;
  const auto take = [&](std::vector<Call>& calls) {
    const auto is_of_other = [&](const Call& call) { return call.agent != &agent || call.service != service; };
    const auto first = std::stable_partition(calls.begin(), calls.end(), is_of_other);
    std::move(first, calls.end(), std::back_inserter(taken));
    calls.erase(first, calls.end());
  };
  take(waiting_);
  const std::lock_guard lock(mutex_);
  take(arrived_);
  return taken;
}

bool HeldCalls::IsEmpty() {
  const std::lock_guard lock(mutex_);
  return arrived_.empty() && waiting_.empty();
}

void HeldCalls::Pass(const Call& call) {
  call.agent->SendRequest(call.service, call.request);
}

bool HeldCalls::IsAwaited(const Call& call, const Tick& tick) {
  bool may_be_node = false;
  const std::set<std::string> watched = watch_.WatchedOf(call.caller, may_be_node);
  return (may_be_node && !tick.missing.empty()) ||
         std::any_of(watched.begin(), watched.end(),
                     [&tick](const std::string& name) { return tick.missing.contains(name); });
}

HeldCalls::Callers HeldCalls::FindCallers(const std::set<std::string>& missing) {
  Callers callers;
  std::set<dds_instance_handle_t> unknown;
  for (const Call& call : waiting_) {
    const auto [caller, is_new] = callers.try_emplace(call.caller);
    if (!is_new) continue;
    bool may_be_node = false;
    Caller& found = caller->second;
    found.participants = watch_.WatchedOf(call.caller, may_be_node);
    if (may_be_node) unknown.insert(call.caller);
  }
  FindUnknown(missing, unknown, callers);
  for (auto& [program, caller] : callers) {
    const std::vector<std::string> services = watch_.ParameterServicesOf(program);
    if (!services.empty()) caller.name = *std::min_element(services.begin(), services.end());
    if (!caller.participants.empty()) caller.name = TextOf(*caller.participants.begin());
  }
  return callers;
}

void HeldCalls::FindUnknown(std::set<std::string> missing, const std::set<dds_instance_handle_t>& programs,
                            Callers& callers) {
  for (const auto& [program, caller] : callers) {
    for (const std::string& name : caller.participants) missing.erase(name);
  }
  std::map<std::string, dds_instance_handle_t> others;  // by the name of a service; programs without one come last
  for (const dds_instance_handle_t program : programs) {
    std::vector<std::string> services = watch_.ParameterServicesOf(program);
    std::sort(services.begin(), services.end());
    const auto is_missing = [&](const std::string& service) { return missing.contains(NodeOf(service)); };
    const auto found = std::find_if(services.begin(), services.end(), is_missing);
    if (found == services.end()) {
      others.emplace(services.empty() ? "~" + std::to_string(program) : services.front(), program);
      continue;
    }
    callers[program].participants.insert(NodeOf(*found));
    missing.erase(NodeOf(*found));
  }
  auto next = others.begin();
  for (const std::string& name : missing) {
    if (next == others.end()) return;
    if (!TopicWatch::IsNode(name) || watch_.IsHeard(name)) continue;
    callers[next->second].participants.insert(name);
    ++next;
  }
}

std::set<std::string> HeldCalls::Update(const Tick& tick) {
  std::vector<Call> arrived;
  {
    const std::lock_guard lock(mutex_);
    arrived.swap(arrived_);
  }
  for (Call& call : arrived) {
    if (IsAwaited(call, tick)) {
      waiting_.push_back(std::move(call));
    } else {
      Pass(call);
    }
  }
  if (waiting_.empty()) return {};
  const Callers callers = FindCallers(tick.missing);
  std::set<std::string> missing = tick.missing;
  std::set<std::string> calling;
  for (const auto& [program, caller] : callers) {
    for (const std::string& name : caller.participants) {
      if (missing.erase(name) > 0) calling.insert(name);
    }
  }
  for (const std::string& name : tick.waiting) missing.erase(name);
  const bool is_complete = tick.missing.empty() || (tick.is_told && missing.empty());
  if (!is_complete) return calling;
  std::vector<Call> passed = std::exchange(waiting_, {});
  // Stable: calls of one program stay in the order in which it has made them.
  std::stable_sort(passed.begin(), passed.end(), [&callers](const Call& a, const Call& b) {
    return callers.at(a.caller).name < callers.at(b.caller).name;
  });
  for (const Call& call : passed) Pass(call);
  return {};
}

}  // namespace troupe::ros
