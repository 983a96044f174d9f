// A ROS peer on Fast DDS: reads robots' topics, prints each message as a JSON line {"topic", "stamp" in ns, ...} and
// drives robots by Twist. Loopback only. Runs until it is killed or its parent has ended.
// Prints {"topic": "enough"} after ENOUGH scans of each robot.
//   fastdds_peer DOMAIN ENOUGH ROBOT=VX,WZ ...
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <string>
#include <vector>

#include "discoveryPubSubTypes.h"
#include "geometryPubSubTypes.h"
#include "navigationPubSubTypes.h"
#include "peer.h"
#include "sensorsPubSubTypes.h"
#include "stdPubSubTypes.h"
#include "visionPubSubTypes.h"
#include "visualizationPubSubTypes.h"

namespace {

std::int64_t Nanoseconds(const builtin_interfaces::msg::dds_::Time_& time) {
  return time.sec() * std::int64_t{1'000'000'000} + time.nanosec();
}
json ToJson(const geometry_msgs::msg::dds_::Vector3_& v) {
  return {v.x(), v.y(), v.z()};
}
json ToJson(const geometry_msgs::msg::dds_::Point_& p) {
  return {p.x(), p.y(), p.z()};
}
json ToJson(const geometry_msgs::msg::dds_::Quaternion_& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}
void Add(json& out, const std_msgs::msg::dds_::Header_& header) {
  out["stamp"] = Nanoseconds(header.stamp());
  out["frame"] = header.frame_id();
}

void Add(json& out, const std_msgs::msg::dds_::Bool_& message) {
  out["data"] = message.data();
}
void Add(json& out, const std_msgs::msg::dds_::String_& message) {
  out["data"] = message.data();
}
void Add(json& out, const rosgraph_msgs::msg::dds_::Clock_& message) {
  out["stamp"] = Nanoseconds(message.clock());
}
void Add(json& out, const nav_msgs::msg::dds_::Odometry_& message) {
  Add(out, message.header());
  out["child"] = message.child_frame_id();
  out["position"] = ToJson(message.pose().pose().position());
  out["orientation"] = ToJson(message.pose().pose().orientation());
  out["pose_covariance"] = message.pose().covariance();
  out["linear"] = ToJson(message.twist().twist().linear());
  out["angular"] = ToJson(message.twist().twist().angular());
  out["twist_covariance"] = message.twist().covariance();
}
void Add(json& out, const nav_msgs::msg::dds_::OccupancyGrid_& message) {
  Add(out, message.header());
  out["resolution"] = message.info().resolution();
  out["width"] = message.info().width();
  out["height"] = message.info().height();
  out["origin"] = ToJson(message.info().origin().position());
  std::uint64_t occupied = 0;
  std::uint64_t free = 0;
  for (const auto cell : message.data()) {
    occupied += cell == 100;
    free += cell == 0;
  }
  out["cells"] = message.data().size();
  out["occupied"] = occupied;
  out["free"] = free;
}
void Add(json& out, const sensor_msgs::msg::dds_::LaserScan_& message) {
  Add(out, message.header());
  out["angles"] = {message.angle_min(), message.angle_max(), message.angle_increment()};
  out["times"] = {message.time_increment(), message.scan_time()};
  out["limits"] = {message.range_min(), message.range_max()};
  out["ranges"] = message.ranges();
  out["intensities"] = message.intensities();
}
void Add(json& out, const sensor_msgs::msg::dds_::Range_& message) {
  Add(out, message.header());
  out["radiation"] = message.radiation_type();
  out["fov"] = message.field_of_view();
  out["limits"] = {message.min_range(), message.max_range()};
  out["range"] = message.range();
  out["variance"] = message.variance();
}
void Add(json& out, const sensor_msgs::msg::dds_::PointCloud2_& message) {
  Add(out, message.header());
  out["size"] = {message.width(), message.height()};
  out["steps"] = {message.point_step(), message.row_step()};
  out["flags"] = {message.is_bigendian(), message.is_dense()};
  for (const auto& field : message.fields()) {
    out["fields"].push_back({field.name(), field.offset(), field.datatype(), field.count()});
  }
  out["data"] = message.data();
}
void AddDetection(json& out, const std::string& id,
                  const std::vector<vision_msgs::msg::dds_::ObjectHypothesisWithPose_>& results) {
  out["id"] = id;
  for (const auto& result : results) {
    out["class"] = result.hypothesis().class_id();
    out["score"] = result.hypothesis().score();
    out["position"] = ToJson(result.pose().pose().position());
    out["orientation"] = ToJson(result.pose().pose().orientation());
  }
}
void Add(json& out, const vision_msgs::msg::dds_::Detection3DArray_& message) {
  Add(out, message.header());
  out["detections"] = json::array();
  for (const auto& detection : message.detections()) {
    json one;
    Add(one, detection.header());
    AddDetection(one, detection.id(), detection.results());
    one["center"] = ToJson(detection.bbox().center().position());
    one["size"] = ToJson(detection.bbox().size());
    out["detections"].push_back(one);
  }
}
void Add(json& out, const vision_msgs::msg::dds_::Detection2DArray_& message) {
  Add(out, message.header());
  out["detections"] = json::array();
  for (const auto& detection : message.detections()) {
    json one;
    Add(one, detection.header());
    AddDetection(one, detection.id(), detection.results());
    const auto& box = detection.bbox();
    one["box"] = {box.center().position().x(), box.center().position().y(), box.size_x(), box.size_y()};
    out["detections"].push_back(one);
  }
}
void Add(json& out, const sensor_msgs::msg::dds_::BatteryState_& message) {
  Add(out, message.header());
  out["percentage"] = message.percentage();
  out["status"] = message.power_supply_status();
  out["present"] = message.present();
}
void Add(json& out, const sensor_msgs::msg::dds_::Imu_& message) {
  Add(out, message.header());
  out["orientation"] = {message.orientation().z(), message.orientation().w()};
  out["turn"] = message.angular_velocity().z();
  const auto& force = message.linear_acceleration();
  out["force"] = {force.x(), force.y(), force.z()};
  out["force_variance"] = message.linear_acceleration_covariance()[0];
}
void Add(json& out, const sensor_msgs::msg::dds_::JointState_& message) {
  Add(out, message.header());
  out["name"] = message.name();
  out["position"] = message.position();
  out["velocity"] = message.velocity();
  out["effort"] = message.effort();
}
void Add(json& out, const tf2_msgs::msg::dds_::TFMessage_& message) {
  for (const auto& transform : message.transforms()) {
    json one;
    Add(one, transform.header());
    one["child"] = transform.child_frame_id();
    one["translation"] = ToJson(transform.transform().translation());
    one["rotation"] = ToJson(transform.transform().rotation());
    out["transforms"].push_back(one);
  }
}
void Add(json& out, const visualization_msgs::msg::dds_::MarkerArray_& message) {
  for (const auto& marker : message.markers()) {
    json one;
    Add(one, marker.header());
    one["ns"] = marker.ns();
    one["id"] = marker.id();
    one["type"] = marker.type();
    one["action"] = marker.action();
    one["position"] = ToJson(marker.pose().position());
    one["scale"] = ToJson(marker.scale());
    one["color"] = {marker.color().r(), marker.color().g(), marker.color().b(), marker.color().a()};
    one["points"] = marker.points().size();
    out["markers"].push_back(one);
  }
}
void Add(json& out, const rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_& message) {
  for (const auto& node : message.node_entities_info_seq()) {
    out["nodes"].push_back({{"namespace", node.node_namespace().to_string()},
                            {"name", node.node_name().to_string()},
                            {"readers", node.reader_gid_seq().size()},
                            {"writers", node.writer_gid_seq().size()}});
  }
}

// Prints and counts the messages of a topic.
template <typename PubSubType>
const std::atomic<int>& Read(Peer& peer, const std::string& topic, bool latched = false) {
  const std::atomic<int>* received = nullptr;
  peer.Read<PubSubType>(
      topic,
      [topic](const typename PubSubType::type& message) {
        json line = {{"topic", topic}};
        Add(line, message);
        Print(line);
      },
      latched, &received);
  return *received;
}

struct Drive {
  const std::atomic<int>* scans = nullptr;
  // Before there are some, the robot is not driven: a part of its way would not be seen.
  const std::atomic<int>* odometry = nullptr;
  const std::atomic<int>* stalls = nullptr;
  DataWriter* writer = nullptr;
  geometry_msgs::msg::dds_::Twist_ twist;
  DataWriter* radio = nullptr;
  std_msgs::msg::dds_::String_ message;
};

int Run(int argc, char** argv) {
  Peer peer(static_cast<std::uint32_t>(std::stoul(argv[1])));
  Read<rosgraph_msgs::msg::dds_::Clock_PubSubType>(peer, "/clock");
  Read<tf2_msgs::msg::dds_::TFMessage_PubSubType>(peer, "/tf");
  Read<tf2_msgs::msg::dds_::TFMessage_PubSubType>(peer, "/tf_static", true);
  Read<nav_msgs::msg::dds_::OccupancyGrid_PubSubType>(peer, "/map", true);
  Read<visualization_msgs::msg::dds_::MarkerArray_PubSubType>(peer, "/blocks", true);
  Read<std_msgs::msg::dds_::String_PubSubType>(peer, "/events");
  Read<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType>(peer, "ros_discovery_info", true);
  std::vector<Drive> drives;
  const int enough = std::stoi(argv[2]);
  for (int i = 3; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string robot = "/" + argument.substr(0, argument.find('='));
    Drive drive;
    drive.odometry = &Read<nav_msgs::msg::dds_::Odometry_PubSubType>(peer, robot + "/odom");
    Read<nav_msgs::msg::dds_::Odometry_PubSubType>(peer, robot + "/ground_truth");
    Read<sensor_msgs::msg::dds_::Range_PubSubType>(peer, robot + "/sonar");
    Read<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(peer, robot + "/sonar/points");
    Read<sensor_msgs::msg::dds_::JointState_PubSubType>(peer, robot + "/joint_states");
    Read<vision_msgs::msg::dds_::Detection3DArray_PubSubType>(peer, robot + "/fiducial/detections");
    Read<vision_msgs::msg::dds_::Detection2DArray_PubSubType>(peer, robot + "/blobfinder/detections");
    Read<sensor_msgs::msg::dds_::BatteryState_PubSubType>(peer, robot + "/battery");
    Read<sensor_msgs::msg::dds_::Imu_PubSubType>(peer, robot + "/imu/data");
    Read<std_msgs::msg::dds_::String_PubSubType>(peer, robot + "/gripper/state");
    Read<std_msgs::msg::dds_::String_PubSubType>(peer, robot + "/radio/received");
    drive.stalls = &Read<std_msgs::msg::dds_::Bool_PubSubType>(peer, robot + "/stalled");
    Read<std_msgs::msg::dds_::String_PubSubType>(peer, robot + "/robot_description", true);
    drive.scans = &Read<sensor_msgs::msg::dds_::LaserScan_PubSubType>(peer, robot + "/scan");
    drive.writer = peer.Write<geometry_msgs::msg::dds_::Twist_PubSubType>(robot + "/cmd_vel");
    double vx = 0.0;
    double wz = 0.0;
    std::sscanf(argument.c_str() + argument.find('=') + 1, "%lf,%lf", &vx, &wz);
    drive.twist.linear().x(vx);
    drive.twist.angular().z(wz);
    drive.radio = peer.Write<std_msgs::msg::dds_::String_PubSubType>(robot + "/radio/send");
    drive.message.data("{\"text\": \"a peer speaks for " + robot.substr(1) + "\"}");
    drives.push_back(drive);
  }
  Print({{"topic", "ready"}});
  bool said = false;
  for (const pid_t parent = getppid(); getppid() == parent; usleep(50'000)) {
    for (Drive& drive : drives) {
      if (*drive.odometry > 0 && *drive.stalls > 0) drive.writer->write(&drive.twist);
      drive.radio->write(&drive.message);
    }
    if (!said &&
        std::all_of(drives.begin(), drives.end(), [=](const Drive& drive) { return *drive.scans >= enough; })) {
      Print({{"topic", "enough"}});
      said = true;
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  return Run(argc, argv);
}
