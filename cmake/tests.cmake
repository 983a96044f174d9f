# How tests are declared. Many tests share a program: a link of each would take longer than most of them run.
set(TROUPE_TEST_OPTIONS "" CACHE STRING "Options for the compiler, for the sources of tests only")
set(TROUPE_TEST_LABEL "" CACHE STRING "Only tests with this label are built and run, for instance: threads")
set(TROUPE_TEST_NAMES "" CACHE STRING "Only tests whose names match this regular expression are built and run")

# The environment of programs with sanitizers. Leaks in libraries that the file names are not reported. Cyclone DDS is
# not built with the thread sanitizer, so its atomics are not seen: its reads and writes are not checked, while its locks
# count.
set(TROUPE_SANITIZER_ENVIRONMENT
  LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/sanitizers/leak.supp:print_suppressions=0
  TSAN_OPTIONS=ignore_noninstrumented_modules=1)

troupe_precompiled_headers(troupe_test_headers
  HEADERS <gmock/gmock.h> <gtest/gtest.h> <Eigen/Core> <Eigen/Geometry> <chrono> <filesystem> <fstream> <map>
          <nlohmann/json.hpp> <string> <thread> <vector> <common/spatial/scene.h> <transport/protocol/messages.h>
  DEPENDS Eigen3::Eigen nlohmann_json::nlohmann_json GTest::gtest GTest::gmock)
if(TARGET troupe_test_headers)
  target_compile_options(troupe_test_headers PRIVATE ${TROUPE_TEST_OPTIONS})
endif()
add_library(troupe_test_main OBJECT ${PROJECT_SOURCE_DIR}/tests/support/test_main.cc)
target_link_libraries(troupe_test_main PRIVATE troupe_options GTest::gtest GTest::gmock)

# All that the tests need, and the part of it that tests need which are commands.
add_custom_target(test_programs ALL)
add_custom_target(command_programs)
# While these tests run, which mostly wait, scripts/test lets CTest compile the rest. Without the variable the entry does
# nothing.
add_test(NAME test_programs
  COMMAND sh -c "[ -z \"$TROUPE_BUILD_TESTS\" ] || exec \"$0\" --build \"$1\" --target test_programs"
    ${CMAKE_COMMAND} ${CMAKE_BINARY_DIR})
set_tests_properties(test_programs PROPERTIES FIXTURES_SETUP test_programs TIMEOUT 3600 PROCESSORS 8 COST 1000)

# troupe_test_program(GROUP [OPTIMIZED]): the GoogleTest program GROUP_tests, of all tests of that group. OPTIMIZED: the
# tests themselves calculate much.
function(troupe_test_program group)
  cmake_parse_arguments(arg "OPTIMIZED" "" "" ${ARGN})
  set(program ${group}_tests)
  add_executable(${program} EXCLUDE_FROM_ALL $<TARGET_OBJECTS:troupe_test_main>)
  set_target_properties(${program} PROPERTIES UNITY_BUILD_MODE GROUP)
  target_link_libraries(${program} PRIVATE troupe_options GTest::gtest GTest::gmock)
  # The options are -O0 in the presets release and ci: the code under test is optimised, but not the tests, because their
  # optimisation would take longer than they run. The precompiled headers have the same options.
  if(NOT arg_OPTIMIZED OR NOT TROUPE_TEST_OPTIONS)
    target_compile_options(${program} PRIVATE ${TROUPE_TEST_OPTIONS})
    troupe_use_precompiled_headers(${program} troupe_test_headers)
  endif()
endfunction()

# troupe_test(NAME GROUP group SOURCES a_test.cc ... DEPENDS lib ... [LABELS l ...] [TIMEOUT seconds] [NEEDS target ...]
#             [DEFINITIONS d ...] [WAITS seconds] [PROPERTIES name value ...])
# The tests in these sources (or headers), run by CTest as one test. DEPENDS: libraries; NEEDS: what they run or load;
# WAITS: they mostly wait, for so long: they begin early, beside others;
# PROPERTIES: of CTest, for instance COST: about how many seconds it takes, if many (the longest begin first), or
# PROCESSORS: how many of the places for tests, six for each core, it takes. Labels: slow (not in scripts/test), process
# (drives the programs), determinism (whole runs), threads (runs under the thread sanitizer too), addresses (under the
# address sanitizer in .ci/run; all of the group `ground` that have none of the first three have it). In a unity build
# the sources of a folder are compiled together, up to 12 at a time.
function(troupe_test name)
  cmake_parse_arguments(arg "" "GROUP;TIMEOUT;WAITS" "SOURCES;DEPENDS;LABELS;NEEDS;DEFINITIONS;PROPERTIES" ${ARGN})
  if(arg_WAITS)
    list(APPEND arg_PROPERTIES PROCESSORS 1 COST ${arg_WAITS})
  endif()
  if(arg_GROUP STREQUAL "ground" AND NOT arg_LABELS MATCHES "slow|process|determinism")
    list(APPEND arg_LABELS addresses)
  endif()
  set(program ${arg_GROUP}_tests)
  if(NOT TARGET ${program})
    message(FATAL_ERROR "${name}: found the group '${arg_GROUP}', expected one of tests/CMakeLists.txt")
  endif()
  list(TRANSFORM arg_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set(selection ${arg_SOURCES})
  list(TRANSFORM selection REPLACE "^${PROJECT_SOURCE_DIR}/tests/" "")
  list(JOIN selection "," selection)
  set(needs_test_programs TRUE)
  troupe_add_test(COMMAND ${program} --sources=${selection})
  if(NOT TEST ${name})
    return()
  endif()

  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR})
  string(MAKE_C_IDENTIFIER ${folder} folder)
  get_property(count TARGET ${program} PROPERTY count_${folder})
  if(NOT count)
    set(count 0)
  endif()
  math(EXPR batch "${count} / 12")
  set_source_files_properties(${arg_SOURCES} TARGET_DIRECTORY ${program} PROPERTIES UNITY_GROUP ${folder}_${batch})
  list(LENGTH arg_SOURCES length)
  math(EXPR count "${count} + ${length}")
  set_target_properties(${program} PROPERTIES count_${folder} ${count})

  target_sources(${program} PRIVATE ${arg_SOURCES})
  target_link_libraries(${program} PRIVATE ${arg_DEPENDS})
  target_compile_definitions(${program} PRIVATE ${arg_DEFINITIONS})
  add_custom_target(${name})  # so that a test is built by its name
  add_dependencies(${name} ${program})
  add_dependencies(test_programs ${program})
endfunction()

# troupe_command_test(NAME COMMAND program argument ... [LABELS l ...] [TIMEOUT seconds] [NEEDS target ...]
#                     [PROPERTIES name value ...])
# A test that is a command. With exit status 77 it was skipped, for the reason in the last line that it printed.
function(troupe_command_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "COMMAND;LABELS;NEEDS;PROPERTIES" ${ARGN})
  set(needs_test_programs FALSE)
  if("slow" IN_LIST arg_LABELS)
    set(needs_test_programs TRUE)
  endif()
  troupe_add_test(COMMAND ${arg_COMMAND})
endfunction()

# Of both: adds test `name`, if it is selected, with the arguments of the caller.
macro(troupe_add_test)
  if("${name}" MATCHES "${TROUPE_TEST_NAMES}" AND (NOT TROUPE_TEST_LABEL OR TROUPE_TEST_LABEL IN_LIST arg_LABELS))
    add_test(NAME ${name} ${ARGN})
    set(environment TROUPE_SOURCE_DIR=${PROJECT_SOURCE_DIR} TROUPE_BINARY_DIR=${CMAKE_BINARY_DIR})
    if(NOT arg_TIMEOUT)
      set(arg_TIMEOUT 300)
    endif()
    if(TROUPE_SANITIZER)
      math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * 4")  # they slow programs down several times
      list(APPEND environment ${TROUPE_SANITIZER_ENVIRONMENT})
    endif()
    if(CMAKE_CROSSCOMPILING)
      math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * 20")  # an emulator, too
      list(APPEND environment CMAKE_TOOLCHAIN_FILE=${CMAKE_TOOLCHAIN_FILE})  # of projects that tests build
    endif()
    # With six places for each core (scripts/test), tests that calculate run one a core, and beside each of them two that
    # drive processes, which mostly wait.
    set(processors 4)
    if(TROUPE_SANITIZER)
      set(processors 2)  # of three places for each core
    elseif("process" IN_LIST arg_LABELS)
      set(processors 1)
    endif()
    set_tests_properties(${name} PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}" ENVIRONMENT "${environment}"
      SKIP_RETURN_CODE 77 PROCESSORS ${processors} ${arg_PROPERTIES})
    if(needs_test_programs)
      set_property(TEST ${name} APPEND PROPERTY FIXTURES_REQUIRED test_programs)
    elseif(arg_NEEDS)
      add_dependencies(command_programs ${arg_NEEDS})
    endif()
    if(arg_NEEDS)
      add_dependencies(test_programs ${arg_NEEDS})
    endif()
  endif()
endmacro()
