// A ROS peer on Fast DDS: reads robots' topics and prints what comes as JSON lines {"topic", "stamp" in ns, ...}, and
// drives robots by Twist. Loopback only. Runs until it is killed, or its parent has ended.
// Says {"topic": "enough"} when it has had ENOUGH scans of each.
//   fastdds_peer DOMAIN ENOUGH ROBOT=VX,WZ ...
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "discoveryPubSubTypes.h"
#include "geometryPubSubTypes.h"
#include "navigationPubSubTypes.h"
#include "sensorsPubSubTypes.h"
#include "stdPubSubTypes.h"
#include "visualizationPubSubTypes.h"

namespace {

using namespace eprosima::fastdds::dds;
using nlohmann::json;

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

void Print(const json& line) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

template <typename PubSubType>
class Listener : public DataReaderListener {
 public:
  explicit Listener(std::string topic) : topic_(std::move(topic)) {}
  std::atomic<int> received = 0;
  void on_data_available(DataReader* reader) override {
    typename PubSubType::type message;
    SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      json line = {{"topic", topic_}};
      Add(line, message);
      Print(line);
      ++received;
    }
  }

 private:
  std::string topic_;
};

class Peer {
 public:
  explicit Peer(std::uint32_t domain) {
    DomainParticipantQos qos;
    auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    transport->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(transport);
    participant_ = DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    if (participant_ == nullptr) throw std::runtime_error("cannot make a participant");
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
  }
  ~Peer() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  template <typename PubSubType>
  const std::atomic<int>& Read(const std::string& topic, bool latched = false) {
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.history().kind = KEEP_ALL_HISTORY_QOS;
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    auto listener = std::make_unique<Listener<PubSubType>>(topic);
    subscriber_->create_datareader(MakeTopic<PubSubType>(topic), qos, listener.get());
    const std::atomic<int>& received = listener->received;
    listeners_.push_back(std::move(listener));
    return received;
  }

  template <typename PubSubType>
  DataWriter* Write(const std::string& topic) {
    DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    return publisher_->create_datawriter(MakeTopic<PubSubType>(topic), qos);
  }

 private:
  template <typename PubSubType>
  Topic* MakeTopic(const std::string& name) {
    TypeSupport type(new PubSubType());
    type.register_type(participant_);
    const std::string prefix = name.starts_with("/") ? "rt" : "";
    return participant_->create_topic(prefix + name, type.get_type_name(), TOPIC_QOS_DEFAULT);
  }

  DomainParticipant* participant_ = nullptr;
  Subscriber* subscriber_ = nullptr;
  Publisher* publisher_ = nullptr;
  std::vector<std::unique_ptr<DataReaderListener>> listeners_;
};

struct Drive {
  const std::atomic<int>* scans = nullptr;
  DataWriter* writer = nullptr;
  geometry_msgs::msg::dds_::Twist_ twist;
};

int Run(int argc, char** argv) {
  Peer peer(static_cast<std::uint32_t>(std::stoul(argv[1])));
  peer.Read<rosgraph_msgs::msg::dds_::Clock_PubSubType>("/clock");
  peer.Read<tf2_msgs::msg::dds_::TFMessage_PubSubType>("/tf");
  peer.Read<tf2_msgs::msg::dds_::TFMessage_PubSubType>("/tf_static", true);
  peer.Read<nav_msgs::msg::dds_::OccupancyGrid_PubSubType>("/map", true);
  peer.Read<visualization_msgs::msg::dds_::MarkerArray_PubSubType>("/blocks", true);
  peer.Read<std_msgs::msg::dds_::String_PubSubType>("/events");
  peer.Read<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType>("ros_discovery_info", true);
  std::vector<Drive> drives;
  const int enough = std::stoi(argv[2]);
  for (int i = 3; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string robot = "/" + argument.substr(0, argument.find('='));
    peer.Read<nav_msgs::msg::dds_::Odometry_PubSubType>(robot + "/odom");
    peer.Read<nav_msgs::msg::dds_::Odometry_PubSubType>(robot + "/ground_truth");
    peer.Read<sensor_msgs::msg::dds_::Range_PubSubType>(robot + "/sonar");
    peer.Read<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(robot + "/sonar/points");
    peer.Read<sensor_msgs::msg::dds_::JointState_PubSubType>(robot + "/joint_states");
    peer.Read<std_msgs::msg::dds_::Bool_PubSubType>(robot + "/stalled");
    peer.Read<std_msgs::msg::dds_::String_PubSubType>(robot + "/robot_description", true);
    Drive drive;
    drive.scans = &peer.Read<sensor_msgs::msg::dds_::LaserScan_PubSubType>(robot + "/scan");
    drive.writer = peer.Write<geometry_msgs::msg::dds_::Twist_PubSubType>(robot + "/cmd_vel");
    double vx = 0.0;
    double wz = 0.0;
    std::sscanf(argument.c_str() + argument.find('=') + 1, "%lf,%lf", &vx, &wz);
    drive.twist.linear().x(vx);
    drive.twist.angular().z(wz);
    drives.push_back(drive);
  }
  Print({{"topic", "ready"}});
  bool said = false;
  for (const pid_t parent = getppid(); getppid() == parent; usleep(50'000)) {
    for (Drive& drive : drives) drive.writer->write(&drive.twist);
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
