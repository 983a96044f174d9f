#include "ros/service_bridge/robot_list_reader.h"

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <stdexcept>
#include <string>

#include "ros/connection/type_hash.h"
#include "ros/service_bridge/raw_type.h"
#include "ros/service_bridge/serialized_text.h"

namespace troupe::ros {
namespace {

namespace fast = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

fast::DataReaderQos Latched(const std::string& user_data) {
  fast::DataReaderQos qos;
  qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = fast::TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  qos.data_sharing().off();
  qos.user_data().setValue({user_data.begin(), user_data.end()});
  return qos;
}

}  // namespace

RobotListReader::RobotListReader(const LinkPort& run, Distribution distribution, Inbox& inbox)
    : run_(run), inbox_(inbox), part_(inbox.NewPart()) {
  fast::TypeSupport(new RawType(kRobotListType)).register_type(run.participant);
  topic_ = run.participant->create_topic(kRobotListTopic, kRobotListType, fast::TOPIC_QOS_DEFAULT);
  const fast::DataReaderQos qos = Latched(TypeMark(distribution, kRobotListType));
  if (topic_ != nullptr) reader_ = run.subscriber->create_datareader(topic_, qos, this);
  if (reader_ != nullptr) return;
  if (topic_ != nullptr) run.participant->delete_topic(topic_);
  throw std::runtime_error("cannot read the list of robots");
}

RobotListReader::~RobotListReader() {
  run_.subscriber->delete_datareader(reader_);
  run_.participant->delete_topic(topic_);
}

void RobotListReader::on_data_available(fast::DataReader*) {
  inbox_.Notify(part_);
}

std::optional<RobotList> RobotListReader::Take() {
  std::optional<RobotList> newest;
  Bytes sample;
  fast::SampleInfo info;
  while (reader_->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    const std::optional<std::string> text = SerializedText(sample);
    if (std::optional<RobotList> list = text ? ParseRobotList(*text) : std::nullopt) newest = std::move(list);
  }
  return newest;
}

}  // namespace troupe::ros
