// An executor for rclcpp nodes for which the ticks of Troupe wait (docs/ros2-lockstep.md of Troupe).
//
//   rclcpp::init(argc, argv);
//   troupe_lockstep::Spin({std::make_shared<MyNode>()}, "driver", {"scan"});
//
// For each tick it waits until the nodes have all messages of the tick, delivers them in a fixed order, runs the timers of
// simulated time that are due, and answers. All callbacks run in the calling thread, so that no callback group runs beside
// another.
#pragma once

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rclcpp/rclcpp.hpp"
#include "std_msgs/msg/header.hpp"

namespace troupe_lockstep {

class LockstepExecutor {
 public:
  using Nodes = std::vector<std::shared_ptr<rclcpp::Node>>;

  // `nodes`: in the order of their callbacks. `name`: by which --ros-lockstep names them. `needs`: topics of which a message
  // must have arrived before the first answer. Throws std::invalid_argument for a node that cannot take part.
  LockstepExecutor(Nodes nodes, std::string name, const std::vector<std::string>& needs = {})
      : nodes_(std::move(nodes)), name_(std::move(name)) {
    std::string plain = name_;
    std::replace_if(plain.begin(), plain.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    control_ = std::make_shared<rclcpp::Node>("lockstep_" + plain);
    ticks_ = control_->create_subscription<std_msgs::msg::Header>(
        "/world/tick", rclcpp::QoS(1).reliable().transient_local(),
        [this](const std_msgs::msg::Header& tick) { tick_ = tick; });
    done_ = control_->create_publisher<std_msgs::msg::Header>("/world/tick_done", rclcpp::QoS(10));
    for (const std::string& topic : needs) {
      needs_.insert(nodes_.front()->get_node_topics_interface()->resolve_topic_name(topic));
    }
    for (const auto& node : nodes_) {
      ForEachGroup(*node, [&](rclcpp::CallbackGroup& group) {
        group.find_client_ptrs_if([&](const rclcpp::ClientBase::SharedPtr&) -> bool {
          throw std::invalid_argument(std::string("node ") + node->get_name() +
                                      " has clients, whose answers belong to no tick");
        });
      });
      node->set_parameter(rclcpp::Parameter("use_sim_time", true));
    }
  }

  // Until rclcpp is shut down.
  void Spin() {
    while (rclcpp::ok()) {
      FindInputs();
      Wait();
      for (Input& input : inputs_) Take(input);
      TakeTick();
      Serve();
      if (!tick_) continue;
      const Tick tick = ParseTick(*tick_);
      if (last_ && tick.stamp < last_->first) last_.reset();  // a reset
      const std::pair<std::int64_t, std::uint64_t> id(tick.stamp, tick.edition);
      if (last_ != id) {  // else it is announced again, with nothing new
        if (!HasAll(tick)) continue;
        RunTick(tick);
        last_ = id;
      }
      Answer(tick);
    }
  }

 private:
  struct Message {
    std::shared_ptr<void> content;
    rclcpp::MessageInfo info;
  };
  struct Input {
    rclcpp::SubscriptionBase::SharedPtr subscription;
    std::string topic;
    std::vector<Message> waiting = {};
  };
  // An announcement.
  struct Tick {
    std::int64_t stamp = 0;                        // ns
    std::uint64_t edition = 0;                     // of the world
    std::map<std::string, std::uint64_t> counts;  // of messages, by topic
  };

  template <typename Call>
  static void ForEachGroup(rclcpp::Node& node, const Call& call) {
    node.get_node_base_interface()->for_each_callback_group(
        [&call](const rclcpp::CallbackGroup::SharedPtr& group) { call(*group); });
  }

  // Subscriptions that were made meanwhile come last.
  void FindInputs() {
    for (const auto& node : nodes_) {
      ForEachGroup(*node, [this](rclcpp::CallbackGroup& group) {
        group.find_subscription_ptrs_if([this](const rclcpp::SubscriptionBase::SharedPtr& found) {
          const bool is_known = std::any_of(inputs_.begin(), inputs_.end(),
                                            [&](const Input& input) { return input.subscription == found; });
          const std::string topic = found->get_topic_name();
          if (!is_known && topic != "/clock" && topic != "/parameter_events") inputs_.push_back({found, topic});
          return false;
        });
      });
    }
  }

  // Until something has arrived, or for a while.
  void Wait() {
    rclcpp::WaitSet waiting;
    for (const Input& input : inputs_) waiting.add_subscription(input.subscription);
    waiting.add_subscription(ticks_);
    // The clock of the nodes follows in a thread of its own.
    const auto result = waiting.wait(std::chrono::milliseconds(tick_ ? 1 : 100));
    static_cast<void>(result);  // what has arrived is taken in any case
    for (const Input& input : inputs_) waiting.remove_subscription(input.subscription);
    waiting.remove_subscription(ticks_);
  }

  static void Take(Input& input) {
    for (;;) {
      Message message{input.subscription->create_message(), {}};
      if (!input.subscription->take_type_erased(message.content.get(), message.info)) return;
      input.waiting.push_back(std::move(message));
    }
  }

  void TakeTick() {
    std_msgs::msg::Header tick;
    rclcpp::MessageInfo info;
    while (ticks_->take(tick, info)) tick_ = tick;
  }

  // Services, as those of parameters. They belong to no tick.
  void Serve() {
    for (const auto& node : nodes_) {
      ForEachGroup(*node, [](rclcpp::CallbackGroup& group) {
        group.find_service_ptrs_if([](const rclcpp::ServiceBase::SharedPtr& service) {
          const auto header = service->create_request_header();
          std::shared_ptr<void> request = service->create_request();
          if (service->take_type_erased_request(request.get(), *header)) service->handle_request(header, request);
          return false;
        });
      });
    }
  }

  static Tick ParseTick(const std_msgs::msg::Header& header) {
    Tick tick;
    tick.stamp = rclcpp::Time(header.stamp).nanoseconds();
    std::istringstream parts(header.frame_id);
    for (std::string part; parts >> part;) {
      const std::size_t colon = part.rfind(':');
      if (colon == std::string::npos) continue;
      const std::string name = part.substr(0, colon);
      const std::uint64_t number = std::stoull(part.substr(colon + 1));
      if (name == "edition") tick.edition = number;
      if (!name.empty() && name.front() == '/') tick.counts[name] = number;
    }
    return tick;
  }

  bool HasAll(const Tick& tick) {
    for (const auto& node : nodes_) {
      if (node->now().nanoseconds() != tick.stamp) return false;
    }
    for (const Input& input : inputs_) {
      const auto count = tick.counts.find(input.topic);
      if (!last_) {
        // Perhaps published before this program came; what it needs is then shown again.
        if (needs_.count(input.topic) > 0 && input.waiting.empty()) return false;
      } else if (count != tick.counts.end() && input.waiting.size() < count->second) {
        return false;
      }
    }
    return last_ || done_->get_subscription_count() > 0;
  }

  void RunTick(const Tick& tick) {
    std::vector<Input*> order;
    for (Input& input : inputs_) order.push_back(&input);
    std::stable_sort(order.begin(), order.end(), [](const Input* a, const Input* b) { return a->topic < b->topic; });
    for (Input* const input : order) {
      std::vector<Message> waiting = std::exchange(input->waiting, {});
      const auto count = tick.counts.find(input->topic);
      // Not what was shown a second time.
      const std::size_t most = last_ || count == tick.counts.end() ? waiting.size() : count->second;
      const std::size_t first = waiting.size() > most ? waiting.size() - most : 0;
      for (std::size_t i = 0; i < waiting.size(); ++i) {
        if (i >= first) input->subscription->handle_message(waiting[i].content, waiting[i].info);
        input->subscription->return_message(waiting[i].content);
      }
    }
    for (const auto& node : nodes_) {
      std::vector<rclcpp::TimerBase::SharedPtr> timers;
      ForEachGroup(*node, [&timers](rclcpp::CallbackGroup& group) {
        group.find_timer_ptrs_if([&timers](const rclcpp::TimerBase::SharedPtr& timer) {
          timers.push_back(timer);
          return false;
        });
      });
      for (const auto& timer : timers) {
        while (!timer->is_canceled() && timer->is_ready()) Call(*timer);
      }
    }
  }

  void Answer(const Tick& tick) {
    std_msgs::msg::Header answer = *tick_;
    answer.frame_id = name_ + " edition:" + std::to_string(tick.edition);
    tick_.reset();
    done_->publish(answer);
  }

  // The interface of timers has changed with Jazzy.
  template <typename Timer>
  static void Call(Timer& timer) {
    if constexpr (std::is_same_v<decltype(timer.call()), bool>) {
      if (timer.call()) timer.execute_callback();
    } else if (const auto data = timer.call()) {
      timer.execute_callback(data);
    }
  }

  const Nodes nodes_;
  const std::string name_;
  std::set<std::string> needs_;
  std::shared_ptr<rclcpp::Node> control_;
  rclcpp::Subscription<std_msgs::msg::Header>::SharedPtr ticks_;
  rclcpp::Publisher<std_msgs::msg::Header>::SharedPtr done_;
  std::vector<Input> inputs_;
  std::optional<std_msgs::msg::Header> tick_;                       // to be answered
  std::optional<std::pair<std::int64_t, std::uint64_t>> last_;  // time and edition of the newest tick that was answered
};

// Runs the nodes until rclcpp is shut down.
inline void Spin(LockstepExecutor::Nodes nodes, std::string name, const std::vector<std::string>& needs = {}) {
  LockstepExecutor(std::move(nodes), std::move(name), needs).Spin();
}

}  // namespace troupe_lockstep
