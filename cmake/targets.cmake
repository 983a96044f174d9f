# Headers that nearly every source reads are parsed once, not once for each source: half the time of a build.
# Sources still include the headers that they use: the option only saves time.
option(TROUPE_PRECOMPILED_HEADERS "Parse the most used headers once" ON)

# troupe_precompiled_headers(NAME [PIC] HEADERS <a> ... DEPENDS lib ...): headers for targets of one kind to share.
function(troupe_precompiled_headers name)
  cmake_parse_arguments(arg "PIC" "" "HEADERS;DEPENDS" ${ARGN})
  if(NOT TROUPE_PRECOMPILED_HEADERS)
    return()
  endif()
  file(WRITE ${CMAKE_BINARY_DIR}/${name}.cc "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/${name}.cc)
  if(NOT EMSCRIPTEN)
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE "${arg_PIC}")
  endif()
  target_link_libraries(${name} PRIVATE troupe_options ${arg_DEPENDS})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

function(troupe_use_precompiled_headers name from)
  if(TROUPE_PRECOMPILED_HEADERS)
    target_precompile_headers(${name} REUSE_FROM ${from})
  endif()
endfunction()

# The optimiser takes half of the time of a compilation, more with the checks of a sanitizer, so the presets for tests
# leave code alone in which tests spend little time.
set(TROUPE_UNOPTIMIZED "" CACHE STRING "Folders whose libraries are compiled with -O0, as a regular expression")

# troupe_library_precompiled_headers(HEADERS ...): those of troupe_library, with more.
function(troupe_library_precompiled_headers)
  set(headers PIC
    HEADERS <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <chrono> <filesystem> <functional> <map> <memory> <mutex>
            <nlohmann/json.hpp> <optional> <set> <span> <string> <utility> <variant> <vector> <troupe/world_state.h> ${ARGN}
    DEPENDS Eigen3::Eigen nlohmann_json::nlohmann_json)
  troupe_precompiled_headers(troupe_library_headers ${headers})
  if(TROUPE_UNOPTIMIZED AND TROUPE_PRECOMPILED_HEADERS)
    troupe_precompiled_headers(troupe_unoptimized_headers ${headers})
    target_compile_options(troupe_unoptimized_headers PRIVATE -O0)
  endif()
endfunction()

# For a library or a program of this folder.
function(troupe_compile_as_its_folder name)
  if(NOT EMSCRIPTEN)  # whose module is linked at fixed addresses
    target_compile_options(${name} PRIVATE -fPIC)  # as the precompiled headers; of a program CMake would make it -fPIE
  endif()
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(TROUPE_UNOPTIMIZED AND folder MATCHES "${TROUPE_UNOPTIMIZED}")
    target_compile_options(${name} PRIVATE -O0)
    troupe_use_precompiled_headers(${name} troupe_unoptimized_headers)
  else()
    troupe_use_precompiled_headers(${name} troupe_library_headers)
  endif()
endfunction()

# troupe_library(NAME SOURCES a.cc ... DEPENDS lib ...): one static library for one folder.
function(troupe_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPENDS" ${ARGN})
  if(arg_SOURCES)
    add_library(${name} STATIC ${arg_SOURCES})
    target_link_libraries(${name} PUBLIC troupe_options ${arg_DEPENDS})
    troupe_compile_as_its_folder(${name})
    set_property(GLOBAL APPEND PROPERTY TROUPE_LIBRARIES ${name})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE troupe_options ${arg_DEPENDS})
  endif()
endfunction()
