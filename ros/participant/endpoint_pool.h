// EndpointPool<Endpoint>: detached endpoints, which are kept for a while for an agent that asks for the same again.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace troupe::ros {

template <typename Endpoint>
class EndpointPool {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void Keep(std::string text, std::unique_ptr<Endpoint> endpoint, Time until) {
    kept_.emplace(std::move(text), Kept{std::move(endpoint), until});
  }
  // One that was kept with this text; null: there is none.
  std::unique_ptr<Endpoint> Take(const std::string& text) {
    const auto found = kept_.find(text);
    if (found == kept_.end()) return nullptr;
    std::unique_ptr<Endpoint> endpoint = std::move(found->second.endpoint);
    kept_.erase(found);
    return endpoint;
  }
  void EndThoseUntil(Time now) {
    std::erase_if(kept_, [now](const auto& kept) { return kept.second.until <= now; });
  }

 private:
  struct Kept {
    std::unique_ptr<Endpoint> endpoint;
    Time until;
  };

  std::multimap<std::string, Kept> kept_;  // by text
};

}  // namespace troupe::ros
