// A reactive driver: for each scan a command. docs/ros2-lockstep.md of Troupe explains the runs that wait for it.
//
//   ros2 run troupe_lockstep driver --ros-args -r scan:=/anna/scan -r cmd_vel:=/anna/cmd_vel
#include <algorithm>
#include <memory>
#include <numeric>
#include <vector>

#include "geometry_msgs/msg/twist.hpp"
#include "rclcpp/rclcpp.hpp"
#include "sensor_msgs/msg/laser_scan.hpp"
#include "troupe_lockstep.hpp"

class Driver : public rclcpp::Node {
 public:
  Driver() : Node("driver") {
    commands_ = create_publisher<geometry_msgs::msg::Twist>("cmd_vel", 10);
    scans_ = create_subscription<sensor_msgs::msg::LaserScan>(
        "scan", 10, [this](const sensor_msgs::msg::LaserScan& scan) { Drive(scan); });
  }

 private:
  void Drive(const sensor_msgs::msg::LaserScan& scan) {
    std::vector<float> ranges = scan.ranges;
    for (float& range : ranges) range = std::min(range, scan.range_max);
    const auto third = static_cast<std::ptrdiff_t>(ranges.size() / 3);
    const bool blocked = *std::min_element(ranges.begin() + third, ranges.end() - third) < 0.7F;
    const double right = std::accumulate(ranges.begin(), ranges.begin() + third, 0.0);
    const double left = std::accumulate(ranges.end() - third, ranges.end(), 0.0);
    geometry_msgs::msg::Twist command;
    command.linear.x = blocked ? 0.0 : 0.4;
    command.angular.z = blocked ? 0.8 : 0.5 * (left - right) / (left + right);
    commands_->publish(command);
  }

  rclcpp::Publisher<geometry_msgs::msg::Twist>::SharedPtr commands_;
  rclcpp::Subscription<sensor_msgs::msg::LaserScan>::SharedPtr scans_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  troupe_lockstep::Spin({std::make_shared<Driver>()}, "driver", {"scan"});
  rclcpp::shutdown();
  return 0;
}
