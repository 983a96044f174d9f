// FastDdsSide: the services of this host for clients on Fast DDS, in a child process (ros/fast_dds). It is started
// again when it ends; calls that wait for their response then get none. All functions are called on one thread.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ros/link/endpoint_text.h"
#include "ros/link/link.h"
#include "ros/messages/ros_options.h"

namespace troupe::ros {

class FastDdsSide {
 public:
  using Clock = std::chrono::steady_clock;
  // Receives a call as the CDR bytes of its request, with a header.
  using OnRequest = std::function<void(std::span<const std::byte> request)>;

  // The arguments by which this program becomes the side: NetworkArguments, and this one.
  static constexpr const char* kFlag = "--fast-dds-side";
  static constexpr int kDescriptor = 3;  // of its end of the link

  // `report`: receives the ends of the process, one line each.
  FastDdsSide(const RosNetwork& network, std::function<void(const std::string&)> report);
  ~FastDdsSide();
  FastDdsSide(const FastDdsSide&) = delete;
  FastDdsSide& operator=(const FastDdsSide&) = delete;

  // Serves a service until Remove of the id that it returns.
  std::uint32_t Add(const ServiceText& service, OnRequest on_request);
  void Remove(std::uint32_t service);
  // Whether the response with a header of this client is one for the side, which it then gets.
  bool Respond(std::uint32_t service, std::uint64_t client_guid, std::span<const std::byte> response);

  // Readable when Process has something to do; -1: none. It changes with each start.
  int descriptor() const { return link_ ? link_->descriptor() : -1; }
  bool has_output() const { return link_ && link_->pending() > 0; }
  // Passes on the calls that have arrived; notices the end of the process, and starts it again when that is due.
  void Process();
  // When Process is to be called in any case.
  std::optional<Clock::time_point> due() const { return due_; }

 private:
  struct Service {
    std::string text;
    OnRequest on_request;
  };

  void Start();
  void Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content = {});

  const std::vector<std::string> arguments_;
  const std::function<void(const std::string&)> report_;
  std::uint64_t guid_ = 0;  // of the client in the headers of its calls; of each process another one
  pid_t child_ = 0;
  std::unique_ptr<Link> link_;  // null: not started
  std::optional<Clock::time_point> due_;
  Clock::time_point started_ = {};
  std::chrono::milliseconds delay_{0};  // of the next start
  std::uint32_t next_service_ = 0;
  std::map<std::uint32_t, Service> services_;
};

}  // namespace troupe::ros
