#include "ros/service_bridge/service_directory.h"

#include <string_view>
#include <utility>

namespace troupe::ros {
namespace {

constexpr std::string_view kRequestPrefix = "rq/";
constexpr std::string_view kRequestSuffix = "Request";
constexpr std::string_view kResponsePrefix = "rr/";
constexpr std::string_view kResponseSuffix = "Reply";

std::optional<std::string> Middle(std::string_view text, std::string_view prefix, std::string_view suffix) {
  if (text.size() <= prefix.size() + suffix.size() || !text.starts_with(prefix) || !text.ends_with(suffix)) {
    return std::nullopt;
  }
  return std::string(text.substr(prefix.size(), text.size() - prefix.size() - suffix.size()));
}

}  // namespace

std::optional<std::string> ServiceOfTopic(const std::string& topic) {
  std::optional<std::string> service = Middle(topic, kRequestPrefix, kRequestSuffix);
  return service ? service : Middle(topic, kResponsePrefix, kResponseSuffix);
}

std::optional<std::string> ServiceDirectory::Add(const Guid& guid, const ServiceEndpoint& endpoint) {
  std::optional<std::string> service = ServiceOfTopic(endpoint.topic);
  if (!service || service_of_.contains(guid) || service_of_.size() >= kMostEndpoints) return std::nullopt;
  const bool is_request = endpoint.topic.starts_with(kRequestPrefix);
  if (is_request != IsReader(guid)) return std::nullopt;  // of a client
  service_of_.emplace(guid, *service);
  Endpoints& endpoints = services_[*service];
  (is_request ? endpoints.readers : endpoints.writers).emplace_back(guid, endpoint);
  return service;
}

std::optional<std::string> ServiceDirectory::Remove(const Guid& guid) {
  const auto found = service_of_.find(guid);
  if (found == service_of_.end()) return std::nullopt;
  std::string service = std::move(found->second);
  service_of_.erase(found);
  const auto endpoints = services_.find(service);
  const auto is_it = [&guid](const auto& entry) { return entry.first == guid; };
  std::erase_if(endpoints->second.readers, is_it);
  std::erase_if(endpoints->second.writers, is_it);
  if (endpoints->second.readers.empty() && endpoints->second.writers.empty()) services_.erase(endpoints);
  return service;
}

std::optional<BridgedService> ServiceDirectory::Find(const std::string& service) const {
  const auto found = services_.find(service);
  if (found == services_.end() || found->second.readers.empty() || found->second.writers.empty()) return std::nullopt;
  return BridgedService{found->second.readers.back().second, found->second.writers.back().second};
}

}  // namespace troupe::ros
