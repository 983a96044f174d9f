# Fails when a folder includes one that it must not: dependencies point one way, and only the edge includes DDS.
#   cmake -DROOT=<source folder> -P architecture_test.cmake
cmake_minimum_required(VERSION 3.25)

# The public headers that belong to a folder of the sources: its rules hold for them.
set(public_headers_of_common/base check deterministic_math enum_names fields ids random result shared)
set(public_headers_of_common/geometry polygon pose rectangle vec2 z_range)
set(public_headers_of_common/bitmap bitmap dense_cover occupancy_grid pixel_area rectangle_cover)
set(public_headers_of_common/model
  color door_description event fleet_message interval named_expectation order person_description radio_limits radio_message robot_command
  sensor_description site_description site_state traffic_state world_description world_state)
set(public_headers_of_common/picture picture_options)
set(public_headers_of_testing/expectations expectation)
foreach(folder common/base common/geometry common/bitmap common/model common/picture testing/expectations)
  foreach(name IN LISTS public_headers_of_${folder})
    set(folder_of_include/troupe/${name}.h ${folder})
  endforeach()
endforeach()

# The folders that each folder may include from, besides itself. From leaf to edge.
set(may_include_common/base include/troupe/version.h)
set(may_include_common/geometry common/base)
set(may_include_common/bitmap common/base common/geometry)
set(may_include_common/image common/base common/bitmap)
set(may_include_common/model common/base common/bitmap common/geometry)
set(may_include_common/signals common/base common/geometry common/model)
set(may_include_common/spatial common/base common/bitmap common/geometry common/model common/traffic)
set(may_include_common/sensing common/base common/geometry common/model common/spatial include/troupe/sensor.h)
set(may_include_common/crowd common/base common/geometry)
set(may_include_common/traffic common/base common/geometry common/model)
set(may_include_common/picture common/base common/bitmap common/geometry common/model)
set(may_include_common/run common/base)
set(may_include_worldfile/text common/base common/geometry)
set(may_include_worldfile/stage common/base common/geometry common/model worldfile/text)
set(may_include_worldfile/map
  common/base common/geometry common/model common/bitmap common/image worldfile/stage worldfile/text)
set(may_include_worldfile/sites
  common/base common/geometry common/model worldfile/stage worldfile/text)
set(may_include_worldfile/grids
  common/base common/geometry common/model common/bitmap common/traffic worldfile/sites worldfile/stage worldfile/text)
set(may_include_worldfile/gazebo
  common/base common/geometry common/model common/bitmap worldfile/sites worldfile/stage worldfile/text)
set(may_include_worldfile/plans common/base common/geometry worldfile/text)
set(may_include_worldfile/models/properties
  common/base common/geometry common/model worldfile/grids worldfile/map worldfile/stage worldfile/text)
set(may_include_worldfile/models/types
  common/base common/geometry common/model worldfile/models/properties worldfile/stage
  worldfile/text)
set(may_include_worldfile/models
  common/base common/geometry common/image common/model common/run common/spatial common/traffic worldfile/grids
  worldfile/map worldfile/models/properties worldfile/models/types worldfile/sites worldfile/stage worldfile/text)
set(may_include_worldfile/scenario
  common/base common/geometry common/model common/bitmap common/run common/spatial
  worldfile/gazebo worldfile/grids worldfile/models worldfile/models/types worldfile/map worldfile/sites
  worldfile/stage worldfile/text)
set(may_include_worldfile/edit
  common/base common/geometry worldfile/stage worldfile/text)
set(may_include_worldfile
  common/base common/geometry common/model
  worldfile/gazebo worldfile/grids worldfile/models worldfile/models/types worldfile/map worldfile/scenario
  worldfile/sites worldfile/stage worldfile/text)
# VDA 5050: messages, and the rules of both sides, as pure functions.
set(may_include_fleet common/base)
set(may_include_transport/mqtt common/base)
set(may_include_transport/protocol common/base common/geometry common/model)
set(may_include_transport/shared_memory common/base common/bitmap common/geometry common/model common/spatial transport/protocol)
set(may_include_transport/security common/base transport/protocol common/run)
set(may_include_common/trace common/base)
set(may_include_command_line common/base transport/mqtt transport/protocol common/run common/trace)
set(may_include_transport/dds/binding common/base)
set(may_include_transport/dds/convert common/base common/bitmap common/geometry common/model transport/protocol transport/dds/binding idl)
set(may_include_transport/wire common/base transport/protocol transport/dds/binding transport/dds/convert idl)
set(may_include_recording/mcap common/base)
set(may_include_recording/timeline common/base common/model common/spatial transport/protocol)
set(may_include_recording
  common/base common/geometry common/model common/spatial transport/protocol common/run transport/dds/binding
  transport/dds/convert transport/wire recording/mcap recording/timeline idl)
set(may_include_transport/dds/transport
  common/base common/geometry common/model transport/protocol common/run transport/security transport/shared_memory transport/dds/binding
  transport/dds/convert idl)
set(may_include_transport/dds/tools
  common/base transport/protocol common/run transport/security transport/dds/binding transport/dds/convert transport/dds/transport idl)
# The ROS messages: made by pure functions in ros/messages, which need no more of DDS than memory for a message.
set(may_include_ros/messages
  common/base common/geometry common/model common/run common/spatial transport/dds/binding idl/ros
  include/troupe/sensor.h)
set(may_include_ros/flags common/base command_line ros/messages)
set(may_include_ros/connection common/base transport/dds/binding ros/messages common/spatial idl/ros)
set(may_include_ros/link common/base ros/messages ros/connection transport/wire)

set(may_include_world-service/core common/base common/crowd common/geometry common/model common/spatial common/traffic)
set(may_include_world-service/service
  common/base common/geometry common/model common/run common/signals common/spatial worldfile worldfile/models transport/protocol
  common/trace world-service/core)
set(may_include_world-service/observers/recorder
  common/base common/geometry common/model common/signals transport/protocol recording recording/mcap common/run common/spatial
  world-service/core world-service/service)
set(may_include_world-service/replay
  common/base common/geometry common/model transport/protocol recording recording/timeline common/run common/sensing common/spatial
  worldfile world-service/core world-service/observers/recorder world-service/service)
set(may_include_world-service/observers/status
  common/base common/model transport/protocol common/run world-service/service)
set(may_include_world-service/observers/fleet
  common/base common/model common/run common/spatial fleet transport/mqtt transport/protocol world-service/service)
set(may_include_world-service/observers/ros
  common/base common/geometry common/image common/model common/run common/spatial transport/protocol transport/dds/binding ros/messages
  ros/connection ros/link idl/ros world-service/core world-service/service worldfile/sites)
set(may_include_world-service/program
  common/base command_line common/model transport/mqtt transport/protocol recording ros/flags ros/messages common/run common/spatial robot-agent/controller
  worldfile worldfile/grids worldfile/models world-service/observers/fleet world-service/observers/recorder world-service/observers/ros world-service/replay
  world-service/service)
set(may_include_world-service
  common/base command_line transport/dds/binding transport/dds/transport ros/messages ros/link common/run transport/security common/spatial
  world-service/program world-service/observers/status world-service/service)

set(may_include_robot-agent/navigation
  common/base common/geometry common/model common/spatial include/troupe/controller.h include/troupe/sensor.h)
set(may_include_robot-agent/controller
  common/base common/geometry common/model common/spatial fleet include/troupe/controller.h include/troupe/parameters.h
  include/troupe/sensor.h robot-agent/gripper robot-agent/navigation)
set(may_include_robot-agent/drive common/base common/geometry common/model include/troupe/controller.h)
set(may_include_robot-agent/gripper common/base common/model include/troupe/controller.h)
set(may_include_robot-agent/robot
  common/base common/geometry common/model common/sensing common/spatial common/trace
  include/troupe/controller.h robot-agent/controller robot-agent/drive robot-agent/gripper robot-agent/navigation)
set(may_include_robot-agent/agent
  common/base common/geometry common/model common/spatial transport/protocol common/trace robot-agent/robot)
set(may_include_robot-agent/ros
  common/base common/geometry common/model common/spatial transport/dds/binding ros/messages ros/connection ros/link
  include/troupe/controller.h robot-agent/agent robot-agent/controller robot-agent/drive robot-agent/robot)
set(may_include_robot-agent/program
  common/base command_line transport/protocol ros/flags ros/messages common/run robot-agent/agent)
set(may_include_robot-agent
  common/base command_line transport/dds/binding transport/dds/transport transport/protocol ros/messages ros/link common/run transport/security
  robot-agent/program robot-agent/ros)

# For ROS clients on Fast DDS, which only this folder includes.
set(may_include_ros/fast_dds common/base ros/messages ros/connection ros/link)
set(may_include_ros/participant
  common/base command_line transport/dds/binding ros/flags ros/messages ros/connection ros/link ros/fast_dds common/run transport/wire)

# The other public headers, each with a rule of its own: folders on all levels include one.
set(may_include_include/troupe/version.h "")
set(may_include_include/troupe/sensor.h common/base common/geometry common/model)
set(may_include_include/troupe/parameters.h common/base common/model)
set(may_include_include/troupe/controller.h
  common/base common/geometry common/model include/troupe/parameters.h include/troupe/sensor.h)
set(may_include_include/troupe/simulation.h
  common/base common/bitmap common/geometry common/model common/picture include/troupe/controller.h include/troupe/sensor.h)

# Expectations know a run by its ticks, wherever they come from.
set(may_include_testing/expectations
  common/base common/geometry common/model common/sensing common/signals common/spatial)
set(may_include_include/troupe/testing.h common/base testing/expectations include/troupe/simulation.h)

# Cases of tests run on simulations.
set(may_include_testing/cases
  common/base common/geometry common/model common/picture robot-agent/controller include/troupe/simulation.h testing/expectations worldfile/models
  worldfile/scenario worldfile/stage worldfile/text)
set(may_include_testing/reports
  common/base common/model common/picture include/troupe/simulation.h recording/mcap testing/cases testing/expectations
  transport/protocol transport/wire)

# The library: the step and the robots in one process, without protocol or DDS.
set(may_include_library
  common/base common/geometry common/model common/picture common/sensing common/spatial worldfile
  include/troupe/simulation.h robot-agent/controller robot-agent/drive robot-agent/robot testing/expectations
  world-service/core)

# For programs that link the library, too: recorded runs, and the page of a simulation, whose states travel as messages.
set(may_include_include/troupe/recorded_simulation.h common/base include/troupe/simulation.h)
set(may_include_include/troupe/simulation_page.h common/base include/troupe/simulation.h)
set(may_include_include/troupe/simulation_recorder.h common/base include/troupe/simulation.h)
set(may_include_include/troupe/snapshot_bytes.h common/base include/troupe/simulation.h)
set(may_include_library/runs
  common/base common/model common/spatial include/troupe/recorded_simulation.h include/troupe/simulation.h
  include/troupe/simulation_page.h include/troupe/simulation_recorder.h include/troupe/snapshot_bytes.h include/troupe/version.h library recording
  recording/mcap recording/timeline transport/protocol transport/wire world-service/core world-service/replay)

# The package for Python, on the library and, for controllers, on what those may include.
set(may_include_python/native common/base common/geometry common/model include/troupe/controller.h include/troupe/sensor.h
  include/troupe/recorded_simulation.h include/troupe/simulation.h include/troupe/simulation_page.h
  include/troupe/simulation_recorder.h include/troupe/snapshot_bytes.h include/troupe/version.h
  common/signals testing/expectations)

# The gateway of the viewer knows a run by the transport's interface only; the page is a table of files.
set(may_include_viewer/foxglove
  common/base common/geometry common/model common/signals common/spatial include/troupe/sensor.h)
set(may_include_viewer/gateway
  common/base common/geometry common/model common/picture transport/protocol common/sensing common/signals common/spatial
  include/troupe/sensor.h recording/timeline testing/expectations viewer/foxglove worldfile/edit worldfile/text)

# The assembly of all that a page without a server needs.
set(may_include_viewer/module
  common/base common/image common/sensing common/spatial library recording recording/mcap robot-agent/agent robot-agent/controller include/troupe/simulation.h
  testing/cases testing/expectations transport/protocol transport/wire viewer/gateway world-service/replay
  world-service/service worldfile worldfile/map worldfile/sites worldfile/text)

# The editor shows a file as if it were a paused run, and tests it by the library.
set(may_include_viewer/editor
  common/base common/bitmap common/geometry common/image common/model transport/protocol common/spatial
  worldfile worldfile/gazebo worldfile/models worldfile/models/properties worldfile/models/types worldfile/edit worldfile/scenario worldfile/stage
  worldfile/text include/troupe/simulation.h robot-agent/controller robot-agent/drive viewer/gateway world-service/core)

set(may_include_launcher/process common/base)
set(may_include_launcher/hosts
  common/base common/run command_line worldfile/scenario launcher/process)
set(may_include_launcher/supervise
  common/base command_line transport/dds/binding common/model transport/protocol recording ros/flags ros/messages ros/link common/run
  transport/security common/spatial
  common/trace
  worldfile worldfile/grids worldfile/models worldfile/scenario launcher/hosts launcher/process robot-agent/agent
  robot-agent/ros world-service/observers/recorder world-service/program world-service/service)
set(may_include_launcher/export
  common/base common/geometry common/sensing common/signals common/spatial recording/mcap ros/connection ros/messages transport/wire viewer/foxglove common/model worldfile/grids
  world-service/observers/recorder world-service/replay world-service/service)
set(may_include_launcher/driving
  common/base transport/dds/tools common/geometry common/model transport/protocol common/run)
set(may_include_launcher/commands
  common/base command_line fleet transport/dds/tools transport/mqtt common/geometry common/model common/picture transport/protocol
  recording common/run transport/security
  ros/messages common/sensing common/spatial common/trace worldfile worldfile/grids worldfile/models worldfile/scenario
  worldfile/map worldfile/plans worldfile/sites worldfile/text common/bitmap include/troupe/simulation.h launcher/driving launcher/export launcher/hosts launcher/process launcher/supervise library library/runs
  testing/cases testing/expectations testing/reports robot-agent/agent robot-agent/controller viewer/editor viewer/gateway world-service/core world-service/observers/recorder
  world-service/program world-service/replay world-service/service)
set(may_include_launcher common/base command_line launcher/commands)

# Outside transport/dds these files alone may include something of it, and of that nothing that shows DDS itself.
set(dds_users
  launcher/commands/ctl_command.cc launcher/commands/commands.cc launcher/commands/top_command.h
  launcher/commands/top_command.cc launcher/commands/view_command.cc launcher/driving/robot_remote.cc
  robot-agent/main.cc world-service/main.cc)
set(dds_headers_for_others
  transport/dds/tools/control_client.h transport/dds/transport/dds_transport.h transport/dds/binding/network_log.h transport/dds/tools/session_monitor.h
  )
# These folders are the way to ROS 2, which is DDS throughout.
set(dds_folders
  transport/dds/binding transport/dds/convert transport/dds/transport transport/dds/tools recording transport/wire
  viewer/module  # its headers alone
  ros/messages ros/connection ros/link launcher/export robot-agent/ros ros/participant ros/fast_dds world-service/observers/ros)
set(ros_headers_for_others robot-agent/ros/ros_gateway.h world-service/observers/ros/ros_world_gateway.h)

set(failures)
set(patterns)
foreach(top command_line common fleet include launcher library python recording robot-agent ros testing transport viewer/editor
    viewer/foxglove
    viewer/gateway viewer/module world-service worldfile)
  list(APPEND patterns ${ROOT}/${top}/*.h ${ROOT}/${top}/*.cc)
endforeach()
file(GLOB_RECURSE files RELATIVE ${ROOT} ${patterns})
list(FILTER files EXCLUDE REGEX "^viewer/module/standard/")  # headers of the standard library
foreach(file IN LISTS files)
  get_filename_component(folder ${file} DIRECTORY)
  if(DEFINED folder_of_${file})
    set(folder ${folder_of_${file}})
  elseif(folder STREQUAL "include/troupe")
    set(folder ${file})
  endif()
  if(NOT DEFINED may_include_${folder})
    list(APPEND failures "${file}: folder ${folder} has no rule in tests/architecture_test.cmake")
    continue()
  endif()
  file(STRINGS ${ROOT}/${file} lines REGEX "std::ranges::[a-z_]+\\(")
  if(lines AND NOT folder IN_LIST dds_folders)
    list(APPEND failures "${file}: the standard library of the WebAssembly module has no such algorithm: ${lines}")
  endif()
  file(STRINGS ${ROOT}/${file} lines REGEX "^#include ")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include [\"<]([^\">]*)[\">].*" "\\1" header "${line}")
    if(header MATCHES "^fast(dds|rtps)/" AND NOT folder STREQUAL "ros/fast_dds")
      list(APPEND failures "${file} includes ${header}: Fast DDS stays in ros/fast_dds")
    elseif(header MATCHES "^dds/" AND NOT folder IN_LIST dds_folders)
      list(APPEND failures "${file} includes ${header}: DDS stays in transport/dds")
    elseif(line MATCHES "\"")
      get_filename_component(from ${header} DIRECTORY)
      if(DEFINED folder_of_include/${header})
        set(from ${folder_of_include/${header}})
      elseif(from STREQUAL "troupe")
        set(from include/${header})
      endif()
      if(from STREQUAL folder)
        continue()
      endif()
      if(NOT from IN_LIST may_include_${folder})
        list(APPEND failures "${file} includes ${header}: ${folder} must not depend on ${from}")
      elseif(from MATCHES "^(robot-agent|world-service/observers)/ros$" AND NOT from STREQUAL folder AND NOT header IN_LIST ros_headers_for_others)
        list(APPEND failures "${file} includes ${header}: only the headers that make a gateway are for others")
      elseif(from MATCHES "^transport/dds/" AND NOT folder IN_LIST dds_folders AND NOT (file IN_LIST dds_users AND header IN_LIST dds_headers_for_others))
        list(APPEND failures "${file} includes ${header}: only the programs' edges use transport/dds")
      endif()
    endif()
  endforeach()
endforeach()

# The headers for other folders do not include DDS.
foreach(header IN LISTS dds_headers_for_others ros_headers_for_others)
  file(STRINGS ${ROOT}/${header} lines REGEX "^#include .(dds/|idl/|transport/dds/|ros/connection/)")
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
