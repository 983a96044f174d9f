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
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE "${arg_PIC}")
  target_link_libraries(${name} PRIVATE troupe_options ${arg_DEPENDS})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

function(troupe_use_precompiled_headers name from)
  if(TROUPE_PRECOMPILED_HEADERS)
    target_precompile_headers(${name} REUSE_FROM ${from})
  endif()
endfunction()

# troupe_library(NAME SOURCES a.cc ... DEPENDS lib ...): one static library for one folder.
function(troupe_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPENDS" ${ARGN})
  if(arg_SOURCES)
    add_library(${name} STATIC ${arg_SOURCES})
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(${name} PUBLIC troupe_options ${arg_DEPENDS})
    troupe_use_precompiled_headers(${name} troupe_library_headers)
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE troupe_options ${arg_DEPENDS})
  endif()
endfunction()

# The environment of programs with sanitizers. Leaks in libraries that the file names are not reported. Cyclone DDS is not
# built with the thread sanitizer, so its atomics are not seen: its reads and writes are not checked, while its locks count.
set(TROUPE_SANITIZER_ENVIRONMENT
  LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/sanitizers/leak.supp:print_suppressions=0
  TSAN_OPTIONS=ignore_noninstrumented_modules=1)

# troupe_test(NAME SOURCES a_test.cc ... DEPENDS lib ... [LABELS l ...] [TIMEOUT seconds] [OPTIMIZED]): one GoogleTest
# program, run by CTest as one test. OPTIMIZED: it calculates much itself. Labels: slow (not in scripts/test), process
# (drives the programs), determinism, threads (runs under the thread sanitizer too).
function(troupe_test name)
  cmake_parse_arguments(arg "OPTIMIZED" "TIMEOUT" "SOURCES;DEPENDS;LABELS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE troupe_options ${arg_DEPENDS} GTest::gtest GTest::gmock GTest::gtest_main)
  # The options are -O0 in the presets release and ci: the code under test is optimised, but not the tests, because their
  # optimisation would take longer than they run. The precompiled headers have the same options.
  if(NOT arg_OPTIMIZED OR NOT TROUPE_TEST_OPTIONS)
    target_compile_options(${name} PRIVATE ${TROUPE_TEST_OPTIONS})
    troupe_use_precompiled_headers(${name} troupe_test_headers)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  set(environment TROUPE_SOURCE_DIR=${PROJECT_SOURCE_DIR} TROUPE_BINARY_DIR=${CMAKE_BINARY_DIR})
  if(TROUPE_SANITIZER)
    math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * 4")  # they slow programs down several times
    list(APPEND environment ${TROUPE_SANITIZER_ENVIRONMENT})
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}" ENVIRONMENT "${environment}")
endfunction()
