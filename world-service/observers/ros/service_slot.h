// ServiceSlot: a ROS service that can be closed while requests still wait for their answer. Any thread may call it.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "ros/connection/ros_service.h"

namespace troupe {

template <typename Request, typename Response>
class ServiceSlot {
 public:
  using Service = ros::RosService<Request, Response>;

  void Open(const ros::RosNode& node, const std::string& name, typename Service::Handler handler) {
    auto made = std::make_unique<Service>(node, name, std::move(handler), ros::Service(), ros::Serving::kWhenStarted);
    Service& service = *made;
    {
      const std::lock_guard lock(mutex_);
      service_ = std::move(made);
    }
    service.Start();  // after the assignment: a waiting request is handled at once, and answers through the slot
  }
  // No handler runs after it returns.
  void Close() {
    std::unique_ptr<Service> service;
    {
      const std::lock_guard lock(mutex_);
      service.swap(service_);
    }
    // The service ends without the lock: a running handler may be waiting for the lock.
  }
  // Sends the response, unless the slot is closed.
  void Respond(const ros::RosCaller& caller, Response& response) {
    const std::lock_guard lock(mutex_);
    if (service_) service_->Respond(caller, response);
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Service> service_;
};

}  // namespace troupe
