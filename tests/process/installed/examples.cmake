# Builds the examples against the installed package alone, and runs them.
cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/run_in.cmake)

file(REMOVE_RECURSE ${FOLDER})
foreach(example hello_world own_controller)
  file(COPY ${EXAMPLES}/${example} DESTINATION ${FOLDER})  # so that nothing is found beside it
  run_in(${FOLDER} ${CMAKE_COMMAND} -S ${example} -B ${example}/build -DCMAKE_PREFIX_PATH=${PREFIX}
    -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}" -DCMAKE_BUILD_TYPE=Debug)
  run_in(${FOLDER} ${CMAKE_COMMAND} --build ${example}/build)
endforeach()

run_in(${FOLDER} hello_world/build/hello_world ${PREFIX}/share/troupe/worlds/scenarios/demo.json demo.png)
if(NOT text MATCHES "tick  20: .*tick 200: ")
  message(FATAL_ERROR "hello_world printed\n${text}")
endif()
file(SIZE ${FOLDER}/demo.png size)
if(size LESS 10000)
  message(FATAL_ERROR "hello_world's picture has ${size} bytes")
endif()

file(WRITE ${FOLDER}/own.json "{\"world\": \"${PREFIX}/share/troupe/worlds/office.world\", \"robots\": [
  {\"name\": \"anna\", \"model\": \"scout\", \"pose\": [-8, 0, 0],
   \"controller\": {\"name\": \"${FOLDER}/own_controller/build/follow_wall.so\", \"parameters\": {\"speed\": 0.4}}}]}")
run_in(${FOLDER} ${PREFIX}/bin/troupe run own.json --in-process --headless --speed max --ticks 50 --poses own.csv)
file(STRINGS ${FOLDER}/own.csv last REGEX "^50,anna,")
if(NOT last OR last MATCHES "^50,anna,-8,0,")
  message(FATAL_ERROR "with its own controller the robot ended at ${last}")
endif()
