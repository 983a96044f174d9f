#include "world-service/observers/ros/robot_list_output.h"

#include "ros/connection/ros_qos.h"
#include "ros/connection/user_data.h"
#include "transport/dds/binding/wire.h"

namespace troupe {

RobotListOutput::RobotListOutput(ros::RosParticipant& participant, const ros::RosOptions& options)
    : options_(options),
      participant_(participant),
      topic_(participant.participant(), ros::kRobotListTopic),
      writer_(participant.service_publisher(), topic_,
              ros::ToDds(ros::Latched()) << ros::TypeUserData<ros::String>(options.distribution)) {}

void RobotListOutput::ChangeWorld(const WorldDescription& world) {
  const ros::RobotList list = RobotListOf(world, options_);
  if (list == written_) return;
  written_ = list;
  dds::WireArena arena;
  const ros::String text{arena.Copy(ToText(list))};
  if (dds_write(writer_.handle(), &text) != DDS_RETCODE_OK) participant_.CountLost();
}

}  // namespace troupe
