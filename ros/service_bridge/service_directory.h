// ServiceDirectory: the services of a run, from the endpoints that are discovered in its partition. Without DDS. Not
// safe for several threads.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ros/service_bridge/guid.h"

namespace troupe::ros {

// The reader of requests or the writer of responses of a service.
struct ServiceEndpoint {
  std::string topic;  // "rq/anna/reset" + "Request" or "rr/anna/reset" + "Reply"
  std::string type;   // name on DDS
  std::string user_data;
};

struct BridgedService {
  ServiceEndpoint request;
  ServiceEndpoint response;
};

// "rq/anna/reset" + "Request" and "rr/anna/reset" + "Reply": "anna/reset". Nothing for another topic.
std::optional<std::string> ServiceOfTopic(const std::string& topic);

class ServiceDirectory {
 public:
  // A hostile participant can announce any number of endpoints; further ones are ignored.
  static constexpr std::size_t kMostEndpoints = 10'000;

  // The name of the service that is changed; nothing if none is.
  std::optional<std::string> Add(const Guid& guid, const ServiceEndpoint& endpoint);
  std::optional<std::string> Remove(const Guid& guid);

  // The newest endpoints. Nothing unless the service has both.
  std::optional<BridgedService> Find(const std::string& service) const;

 private:
  struct Endpoints {
    std::vector<std::pair<Guid, ServiceEndpoint>> readers;
    std::vector<std::pair<Guid, ServiceEndpoint>> writers;
  };

  std::map<Guid, std::string> service_of_;
  std::map<std::string, Endpoints> services_;
};

}  // namespace troupe::ros
