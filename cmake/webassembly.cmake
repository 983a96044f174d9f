# The preset wasm: the simulation, the reader of recordings and the gateway's side of the page as a WebAssembly module
# (viewer/module), by Debian's emscripten. Of the folders it needs, only what the module needs is built.
set(CMAKE_CXX_FLAGS "${CMAKE_CXX_FLAGS} -fwasm-exceptions")
set(CMAKE_EXE_LINKER_FLAGS "${CMAKE_EXE_LINKER_FLAGS} -fwasm-exceptions")
# Where Debian has the parser with which emscripten shrinks its loader.
set_property(GLOBAL PROPERTY RULE_LAUNCH_LINK "${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs")
# The archiver itself: emscripten's is a Python program around it. It writes the index, too.
find_program(LLVM_AR NAMES llvm-ar-14 llvm-ar REQUIRED)
foreach(language C CXX)
  set(CMAKE_${language}_ARCHIVE_CREATE "${LLVM_AR} qcs <TARGET> <OBJECTS>")
  set(CMAKE_${language}_ARCHIVE_APPEND "${LLVM_AR} qs <TARGET> <OBJECTS>")
  set(CMAKE_${language}_ARCHIVE_FINISH "")
endforeach()

# Of Debian's libraries the headers that need no library: links to them, because the folder that has them has those of
# the host's C library, too.
set(host_headers ${CMAKE_BINARY_DIR}/host_headers)
file(MAKE_DIRECTORY ${host_headers})
foreach(name fmt nlohmann valijson stb dds ddsc)
  if(NOT EXISTS /usr/include/${name})
    message(FATAL_ERROR "/usr/include/${name} is not there: run scripts/setup-wasm")
  endif()
  file(CREATE_LINK /usr/include/${name} ${host_headers}/${name} SYMBOLIC)
endforeach()
file(CREATE_LINK /usr/include/eigen3/Eigen ${host_headers}/Eigen SYMBOLIC)
file(GLOB dds_features /usr/include/*/dds/features.h)
list(GET dds_features 0 dds_features)
get_filename_component(dds_features ${dds_features} DIRECTORY)
file(MAKE_DIRECTORY ${host_headers}/features)
file(CREATE_LINK ${dds_features} ${host_headers}/features/dds SYMBOLIC)
include_directories(BEFORE SYSTEM ${PROJECT_SOURCE_DIR}/viewer/module/standard)
include_directories(SYSTEM ${host_headers} ${host_headers}/features)
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Wno-defaulted-function-deleted>)  # of pairs, whose library has no <=>

function(troupe_header_targets)
  foreach(name IN LISTS ARGN)
    add_library(${name} INTERFACE IMPORTED GLOBAL)
  endforeach()
endfunction()
troupe_header_targets(Eigen3::Eigen nlohmann_json::nlohmann_json Threads::Threads CycloneDDS::ddsc
  PNG::PNG JPEG::JPEG PkgConfig::CAIRO)
add_library(valijson INTERFACE)
add_library(fmt::fmt INTERFACE IMPORTED GLOBAL)
target_link_libraries(fmt::fmt INTERFACE troupe_page_format)
troupe_library_precompiled_headers(<fmt/format.h>)

# What Debian has for this machine only, from its source.
set(yaml ${PROJECT_SOURCE_DIR}/build/wasm-root/yaml-cpp)
file(GLOB yaml_sources ${yaml}/src/*.cpp)
if(NOT yaml_sources)
  message(FATAL_ERROR "${yaml} is not there: run scripts/setup-wasm")
endif()
add_library(yaml-cpp STATIC EXCLUDE_FROM_ALL ${yaml_sources})
set_target_properties(yaml-cpp PROPERTIES UNITY_BUILD_BATCH_SIZE 0)
target_compile_options(yaml-cpp PRIVATE -O0)  # as the readers of files: the link optimizes it a little, as all
target_compile_definitions(yaml-cpp PUBLIC YAML_CPP_STATIC_DEFINE)
target_include_directories(yaml-cpp SYSTEM PUBLIC ${yaml}/include)

# The C types of IDL files, by the host's idlc.
find_program(IDLC idlc REQUIRED)
function(troupe_idl_library name)
  cmake_parse_arguments(arg "NO_TYPE_INFO" "" "FILES" ${ARGN})
  set(sources)
  foreach(file IN LISTS arg_FILES)
    string(REPLACE ".idl" "" stem ${file})
    add_custom_command(OUTPUT idl/${stem}.c idl/${stem}.h
      COMMAND ${IDLC} -l c -t -Wno-implicit-extensibility -I ${PROJECT_SOURCE_DIR} -o idl ${CMAKE_CURRENT_SOURCE_DIR}/${file}
      DEPENDS ${arg_FILES}  # a file includes others
      VERBATIM)
    list(APPEND sources idl/${stem}.c)
  endforeach()
  file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/idl)
  add_library(${name} STATIC ${sources})
  target_include_directories(${name} SYSTEM PUBLIC ${CMAKE_CURRENT_BINARY_DIR})
endfunction()

add_library(troupe_dds_binding INTERFACE)  # its headers alone: the types are read without Cyclone
set(folders
  idl common worldfile fleet transport/protocol transport/dds/convert world-service/core
  robot-agent/drive robot-agent/navigation robot-agent/controller robot-agent/gripper robot-agent/robot
  testing/expectations library)
foreach(folder IN LISTS folders)
  add_subdirectory(${folder} EXCLUDE_FROM_ALL)
endforeach()
add_subdirectory(viewer/module)
