#include "ros/participant/held_calls.h"

#include <algorithm>
#include <utility>

#include "ros/participant/agent_endpoints.h"

namespace troupe::ros {
namespace {

constexpr auto kMaxWait = std::chrono::seconds(5);

}  // namespace

void HeldCalls::Add(Call call) {
  const std::lock_guard lock(mutex_);
  arrived_.push_back(std::move(call));
}

void HeldCalls::Remove(const AgentEndpoints& agent) {
  std::erase_if(waiting_, [&agent](const Waiting& waiting) { return waiting.call.agent == &agent; });
  const std::lock_guard lock(mutex_);
  std::erase_if(arrived_, [&agent](const Call& call) { return call.agent == &agent; });
}

bool HeldCalls::IsEmpty() {
  const std::lock_guard lock(mutex_);
  return arrived_.empty() && waiting_.empty();
}

void HeldCalls::Pass(const Call& call) {
  call.agent->SendRequest(call.service, call.request);
}

std::string HeldCalls::NameOf(dds_instance_handle_t program, const std::set<std::string>& watched) const {
  if (!watched.empty()) return *watched.begin();
  std::vector<std::string> services = watch_.ParameterServicesOf(program);
  return services.empty() ? std::string() : *std::min_element(services.begin(), services.end());
}

bool HeldCalls::HaveAllAnsweredOrCalled(std::set<std::string> missing) {
  std::set<dds_instance_handle_t> unknown;  // programs that have called, and may be a node
  for (const Waiting& waiting : waiting_) {
    bool may_be_node = false;
    for (const std::string& watched : watch_.WatchedOf(waiting.call.caller, may_be_node)) missing.erase(watched);
    if (may_be_node) unknown.insert(waiting.call.caller);
  }
  const auto nodes = static_cast<std::size_t>(
      std::count_if(missing.begin(), missing.end(), [](const std::string& name) { return TopicWatch::IsNode(name); }));
  return nodes == missing.size() && nodes <= unknown.size();
}

std::optional<HeldCalls::Time> HeldCalls::Update(std::set<std::string> missing, bool is_told, Time now) {
  std::vector<Call> arrived;
  {
    const std::lock_guard lock(mutex_);
    arrived.swap(arrived_);
  }
  for (Call& call : arrived) {
    bool may_be_node = false;
    const std::set<std::string> watched = watch_.WatchedOf(call.caller, may_be_node);
    const bool is_awaited =
        std::any_of(watched.begin(), watched.end(), [&](const std::string& name) { return missing.contains(name); }) ||
        (may_be_node && !missing.empty());
    if (!is_awaited) {
      Pass(call);
      continue;
    }
    std::string name = NameOf(call.caller, watched);
    waiting_.push_back({std::move(call), std::move(name), now});
  }
  if (waiting_.empty()) return std::nullopt;
  const bool is_overdue = now - waiting_.front().since > kMaxWait;
  const bool is_complete = missing.empty() || (is_told && HaveAllAnsweredOrCalled(std::move(missing)));
  if (!is_complete && !is_overdue) return waiting_.front().since + kMaxWait;
  std::vector<Waiting> passed = std::exchange(waiting_, {});
  // Stable: calls of one program stay in the order in which it has made them.
  std::stable_sort(passed.begin(), passed.end(),
                   [](const Waiting& a, const Waiting& b) { return a.caller < b.caller; });
  for (const Waiting& waiting : passed) Pass(waiting.call);
  return std::nullopt;
}

}  // namespace troupe::ros
