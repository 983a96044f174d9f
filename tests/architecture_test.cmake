# Fails when a folder includes one that it must not: dependencies point one way, and only the edge includes DDS.
#   cmake -DROOT=<source folder> -P architecture_test.cmake
cmake_minimum_required(VERSION 3.25)

# The folders that each folder may include from, besides itself. From leaf to edge.
set(may_include_common/base include/troupe/version.h)
set(may_include_common/geometry common/base)
set(may_include_common/bitmap common/base common/geometry)
set(may_include_common/image common/base common/bitmap)
set(may_include_common/model common/base common/bitmap common/geometry)
set(may_include_common/spatial common/base common/bitmap common/geometry common/model)
set(may_include_common/sensing common/base common/geometry common/model common/spatial include/troupe/sensor.h)
set(may_include_common/picture common/base common/bitmap common/geometry common/model)
set(may_include_common/run common/base)
set(may_include_common/worldfile/text common/base)
set(may_include_common/worldfile/stage common/base common/worldfile/text)
set(may_include_common/worldfile/map
  common/base common/geometry common/model common/bitmap common/image common/worldfile/stage common/worldfile/text)
set(may_include_common/worldfile/build/properties
  common/base common/geometry common/model common/worldfile/map common/worldfile/stage common/worldfile/text)
set(may_include_common/worldfile/build/types
  common/base common/geometry common/model common/worldfile/build/properties common/worldfile/stage
  common/worldfile/text)
set(may_include_common/worldfile/build
  common/base common/geometry common/image common/model common/run common/spatial common/worldfile/build/properties
  common/worldfile/build/types common/worldfile/stage common/worldfile/text)
set(may_include_common/worldfile/scenario
  common/base common/geometry common/model common/bitmap common/run common/spatial
  common/worldfile/build common/worldfile/build/types common/worldfile/map common/worldfile/stage
  common/worldfile/text)
set(may_include_common/worldfile/edit
  common/base common/geometry common/worldfile/scenario common/worldfile/stage common/worldfile/text)
set(may_include_common/worldfile
  common/base common/geometry common/model
  common/worldfile/build common/worldfile/build/types common/worldfile/map common/worldfile/scenario
  common/worldfile/stage common/worldfile/text)
set(may_include_common/protocol common/base common/geometry common/model)
set(may_include_common/sharing common/base common/geometry common/model common/protocol)
set(may_include_common/security common/base common/protocol common/run)
set(may_include_common/trace common/base)
set(may_include_common/command_line common/base common/protocol common/ros common/run common/trace)
set(may_include_common/dds/binding common/base)
set(may_include_common/dds/convert common/base common/bitmap common/geometry common/model common/protocol common/dds/binding idl)
set(may_include_common/wire common/base common/protocol common/dds/binding common/dds/convert idl)
set(may_include_common/recording/mcap common/base)
set(may_include_common/recording
  common/base common/geometry common/model common/protocol common/run common/dds/binding common/dds/convert common/wire
  common/recording/mcap idl)
set(may_include_common/dds/transport
  common/base common/geometry common/model common/protocol common/run common/security common/sharing common/dds/binding
  common/dds/convert idl)
set(may_include_common/dds/tools
  common/base common/protocol common/run common/security common/dds/binding common/dds/convert common/dds/transport idl)
# The ROS messages: made by pure functions in common/ros, which need no more of DDS than memory for a message.
set(may_include_common/ros
  common/base common/geometry common/model common/spatial common/dds/binding idl/ros
  include/troupe/sensor.h)
set(may_include_common/ros_dds common/base common/dds/binding common/ros common/spatial idl/ros)
set(may_include_common/ros_link common/base common/ros common/ros_dds common/wire)

set(may_include_world-service/core common/base common/geometry common/model common/spatial)
set(may_include_world-service/service
  common/base common/geometry common/model common/run common/spatial common/worldfile common/worldfile/build common/protocol common/trace world-service/core)
set(may_include_world-service/observers/recorder
  common/base common/geometry common/model common/protocol common/recording common/recording/mcap common/run common/spatial
  world-service/core world-service/service)
set(may_include_world-service/replay
  common/base common/geometry common/model common/protocol common/recording common/run common/sensing common/spatial
  common/worldfile world-service/core world-service/observers/recorder world-service/service)
set(may_include_world-service/observers/status
  common/base common/model common/protocol common/run common/worldfile world-service/service)
set(may_include_world-service/observers/ros
  common/base common/geometry common/model common/run common/spatial common/protocol common/dds/binding common/ros
  common/ros_dds world-service/service)
set(may_include_world-service/program
  common/base common/command_line common/model common/protocol common/recording common/ros common/run common/spatial
  common/worldfile common/worldfile/build world-service/observers/recorder world-service/replay world-service/service)
set(may_include_world-service
  common/base common/command_line common/dds/binding common/dds/transport common/ros common/ros_dds common/run common/security common/spatial
  world-service/program
  world-service/observers/ros world-service/observers/status world-service/replay world-service/service)

set(may_include_robot-agent/navigation common/base common/geometry common/model include/troupe/controller.h include/troupe/sensor.h)
set(may_include_robot-agent/controller
  common/base common/geometry common/model include/troupe/controller.h include/troupe/parameters.h
  include/troupe/sensor.h robot-agent/navigation)
set(may_include_robot-agent/drive common/base common/geometry common/model include/troupe/controller.h)
set(may_include_robot-agent/gripper common/base common/model include/troupe/controller.h)
set(may_include_robot-agent/robot
  common/base common/geometry common/model common/sensing common/spatial common/trace
  include/troupe/controller.h robot-agent/controller robot-agent/drive robot-agent/gripper)
set(may_include_robot-agent/agent
  common/base common/geometry common/model common/spatial common/protocol common/trace robot-agent/robot)
set(may_include_robot-agent/ros
  common/base common/geometry common/model common/spatial common/dds/binding common/ros common/ros_dds common/ros_link
  include/troupe/controller.h robot-agent/agent robot-agent/drive robot-agent/robot)
set(may_include_robot-agent/program
  common/base common/command_line common/protocol common/ros common/run robot-agent/agent)
set(may_include_robot-agent
  common/base common/command_line common/dds/binding common/dds/transport common/protocol common/ros common/run common/security
  robot-agent/program robot-agent/ros)

set(may_include_ros-participant
  common/base common/command_line common/dds/binding common/ros common/ros_dds common/ros_link common/run common/wire)

# For ROS clients on Fast DDS, which only this folder includes.
set(may_include_ros-service-bridge
  common/base common/command_line common/ros common/ros_dds common/run)

# The public headers, each with a rule of its own: folders on all levels include one.
set(may_include_include/troupe/version.h "")
set(may_include_include/troupe/sensor.h common/base common/geometry common/model)
set(may_include_include/troupe/parameters.h common/base common/model)
set(may_include_include/troupe/controller.h
  common/base common/geometry common/model include/troupe/parameters.h include/troupe/sensor.h)
set(may_include_include/troupe/simulation.h
  common/base common/geometry common/model common/picture include/troupe/controller.h include/troupe/sensor.h)

# The library: the step and the robots in one process, without protocol or DDS.
set(may_include_library
  common/base common/geometry common/model common/picture common/sensing common/spatial common/worldfile
  include/troupe/simulation.h robot-agent/controller robot-agent/robot world-service/core)

# The gateway of the viewer knows a run by the transport's interface only; the page is a table of files.
set(may_include_viewer/foxglove
  common/base common/geometry common/model common/spatial include/troupe/sensor.h)
set(may_include_viewer/gateway
  common/base common/geometry common/model common/picture common/protocol common/sensing common/spatial viewer/foxglove)

# The editor shows a file as if it were a paused run, and tests it by the library.
set(may_include_viewer/editor
  common/base common/bitmap common/geometry common/image common/model common/protocol common/spatial
  common/worldfile/build common/worldfile/edit common/worldfile/scenario common/worldfile/stage common/worldfile/text
  include/troupe/simulation.h robot-agent/controller robot-agent/drive viewer/gateway world-service/core)

set(may_include_launcher/process common/base)
set(may_include_launcher/hosts
  common/base common/run common/worldfile/scenario launcher/process)
set(may_include_launcher/supervise
  common/base common/command_line common/dds/binding common/model common/protocol common/recording common/ros common/run
  common/security common/spatial
  common/trace
  common/worldfile common/worldfile/build common/worldfile/scenario launcher/hosts launcher/process robot-agent/agent
  robot-agent/ros world-service/observers/recorder world-service/observers/ros world-service/replay world-service/service)
set(may_include_launcher/driving
  common/base common/dds/tools common/geometry common/model common/protocol common/run)
set(may_include_launcher/commands
  common/base common/command_line common/dds/tools common/geometry common/model common/picture common/protocol
  common/recording common/run common/security
  common/ros common/sensing common/spatial common/trace common/worldfile common/worldfile/build common/worldfile/scenario
  common/worldfile/text common/bitmap include/troupe/simulation.h launcher/driving launcher/hosts launcher/process launcher/supervise library
  robot-agent/agent robot-agent/controller viewer/editor viewer/gateway world-service/core world-service/observers/recorder world-service/replay world-service/service)
set(may_include_launcher common/base common/command_line launcher/commands)

# Outside common/dds these files alone may include something of it, and of that nothing that shows DDS itself.
set(dds_users
  launcher/commands/ctl_command.cc launcher/commands/select_session.cc launcher/commands/session_table.h
  launcher/commands/top_command.cc launcher/commands/view_command.cc launcher/driving/robot_remote.cc
  robot-agent/main.cc world-service/main.cc)
set(dds_headers_for_others
  common/dds/tools/control_client.h common/dds/transport/dds_transport.h common/dds/binding/network_log.h common/dds/tools/session_monitor.h
  common/dds/tools/session_observer.h)
# These folders are the way to ROS 2, which is DDS throughout.
set(dds_folders
  common/dds/binding common/dds/convert common/dds/transport common/dds/tools common/recording common/wire
  common/ros common/ros_dds common/ros_link robot-agent/ros ros-participant ros-service-bridge world-service/observers/ros)
set(ros_headers_for_others robot-agent/ros/ros_gateway.h world-service/observers/ros/ros_world_gateway.h)

set(failures)
file(GLOB_RECURSE files RELATIVE ${ROOT}
  ${ROOT}/common/*.h ${ROOT}/common/*.cc ${ROOT}/world-service/*.h ${ROOT}/world-service/*.cc
  ${ROOT}/robot-agent/*.h ${ROOT}/robot-agent/*.cc ${ROOT}/ros-service-bridge/*.h ${ROOT}/ros-service-bridge/*.cc
  ${ROOT}/ros-participant/*.h ${ROOT}/ros-participant/*.cc
  ${ROOT}/launcher/*.h ${ROOT}/launcher/*.cc
  ${ROOT}/include/*.h ${ROOT}/library/*.h ${ROOT}/library/*.cc ${ROOT}/viewer/gateway/*.h ${ROOT}/viewer/gateway/*.cc
  ${ROOT}/viewer/editor/*.h ${ROOT}/viewer/editor/*.cc)
foreach(file IN LISTS files)
  get_filename_component(folder ${file} DIRECTORY)
  if(folder STREQUAL "include/troupe")
    set(folder ${file})
  endif()
  if(NOT DEFINED may_include_${folder})
    list(APPEND failures "${file}: folder ${folder} has no rule in tests/architecture_test.cmake")
    continue()
  endif()
  file(STRINGS ${ROOT}/${file} lines REGEX "^#include ")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include [\"<]([^\">]*)[\">].*" "\\1" header "${line}")
    if(header MATCHES "^fast(dds|rtps)/" AND NOT folder STREQUAL "ros-service-bridge")
      list(APPEND failures "${file} includes ${header}: Fast DDS stays in ros-service-bridge")
    elseif(header MATCHES "^dds/" AND NOT folder IN_LIST dds_folders)
      list(APPEND failures "${file} includes ${header}: DDS stays in common/dds")
    elseif(line MATCHES "\"")
      get_filename_component(from ${header} DIRECTORY)
      if(from STREQUAL "troupe")
        set(from include/${header})
      endif()
      if(from STREQUAL folder)
        continue()
      endif()
      if(NOT from IN_LIST may_include_${folder})
        list(APPEND failures "${file} includes ${header}: ${folder} must not depend on ${from}")
      elseif(from MATCHES "^(robot-agent|world-service/observers)/ros$" AND NOT from STREQUAL folder AND NOT header IN_LIST ros_headers_for_others)
        list(APPEND failures "${file} includes ${header}: only the headers that make a gateway are for others")
      elseif(from MATCHES "^common/dds/" AND NOT folder IN_LIST dds_folders AND NOT (file IN_LIST dds_users AND header IN_LIST dds_headers_for_others))
        list(APPEND failures "${file} includes ${header}: only the programs' edges use common/dds")
      endif()
    endif()
  endforeach()
endforeach()

# The headers for other folders do not include DDS.
foreach(header IN LISTS dds_headers_for_others ros_headers_for_others)
  file(STRINGS ${ROOT}/${header} lines REGEX "^#include .(dds/|idl/|common/dds/|common/ros_dds/)")
  if(lines)
    list(APPEND failures "${header} includes DDS, which must not reach other folders: ${lines}")
  endif()
endforeach()

list(LENGTH files count)
if(count LESS 100)
  list(APPEND failures "found only ${count} source files in ${ROOT}")
endif()
if(failures)
  list(JOIN failures "\n  " text)
  message(FATAL_ERROR "the folders' dependencies are broken:\n  ${text}")
endif()
message(STATUS "the includes of ${count} files follow the rules")
