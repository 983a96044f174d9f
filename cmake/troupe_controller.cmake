# For projects outside this tree: troupe_controller(NAME SOURCES a.cc ...) builds a controller as the shared library
# NAME.so. See docs/controllers.md.
get_filename_component(TROUPE_SOURCE_DIR "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)
find_package(Eigen3 3.4 REQUIRED)

# The few functions that the headers of a controller need. Each controller gets its own copy, so that it depends on no
# symbol of the program that loads it.
add_library(troupe_controller_support STATIC
  ${TROUPE_SOURCE_DIR}/common/base/check.cc
  ${TROUPE_SOURCE_DIR}/common/base/deterministic_math.cc
  ${TROUPE_SOURCE_DIR}/common/base/random.cc
  ${TROUPE_SOURCE_DIR}/common/base/result.cc
  ${TROUPE_SOURCE_DIR}/common/geometry/pose.cc)
target_include_directories(troupe_controller_support PUBLIC ${TROUPE_SOURCE_DIR})
target_compile_features(troupe_controller_support PUBLIC cxx_std_20)
# The flag keeps results the same on every machine.
target_compile_options(troupe_controller_support PUBLIC -ffp-contract=off)
target_link_libraries(troupe_controller_support PUBLIC Eigen3::Eigen)
set_target_properties(troupe_controller_support PROPERTIES
  POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)

function(troupe_controller name)
  cmake_parse_arguments(arg "" "" "SOURCES" ${ARGN})
  add_library(${name} MODULE ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE troupe_controller_support)
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()
