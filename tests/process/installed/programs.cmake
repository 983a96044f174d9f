# Runs an installed world with the installed programs, and looks for their manual pages.
cmake_minimum_required(VERSION 3.25)
string(RANDOM LENGTH 12 session)
file(MAKE_DIRECTORY ${FOLDER})
execute_process(
  COMMAND ${PREFIX}/bin/troupe run ${PREFIX}/share/troupe/worlds/scenarios/demo.json --headless --speed max --ticks 20
    --session installed-${session} --robots-per-process 4 --hash-log hashes
  WORKING_DIRECTORY ${FOLDER} OUTPUT_VARIABLE text ERROR_VARIABLE text RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "troupe run of an installed world: ${failed}\n${text}")
endif()
file(STRINGS ${FOLDER}/hashes hashes)
list(GET hashes -1 last)
if(NOT last MATCHES "^20 ")
  message(FATAL_ERROR "the run ended with ${last}")
endif()

# The example for Nav2 finds the installed worlds.
foreach(scenario one drift three)
  execute_process(COMMAND ${PREFIX}/bin/troupe check ${PREFIX}/share/troupe/examples/nav2/${scenario}.json
    OUTPUT_VARIABLE text ERROR_VARIABLE text RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "troupe check of an installed example: ${failed}\n${text}")
  endif()
endforeach()

execute_process(COMMAND ${PREFIX}/bin/troupe --help OUTPUT_VARIABLE help)
string(REGEX REPLACE ".*Subcommands:\n" "" help "${help}")
string(REGEX MATCHALL "\n  [a-z][a-z-]*" subcommands "\n${help}")
list(LENGTH subcommands count)
if(count LESS 5)
  message(FATAL_ERROR "found the subcommands ${subcommands}")
endif()
list(TRANSFORM subcommands REPLACE "\n  (.*)" "troupe-\\1")
set(programs troupe world-service robot-agent ros-participant)
if(EXISTS ${PREFIX}/bin/ros-service-bridge)  # which not every build has
  list(APPEND programs ros-service-bridge)
endif()
foreach(page ${programs} ${subcommands})
  set(file ${PREFIX}/share/man/man1/${page}.1)
  if(NOT EXISTS ${file})
    message(SEND_ERROR "there is no manual page ${file}")
    continue()
  endif()
  file(READ ${file} text)
  if(NOT text MATCHES "\\.SH NAME\n[^\n]+ \\\\- [^\n]+\n\\.SH SYNOPSIS\n[^\n]+\n\\.SH DESCRIPTION\n")
    message(SEND_ERROR "the manual page ${file} begins\n${text}")
  endif()
endforeach()
