# The contents of `cmake --install`: programs, library, public headers, CMake package, worlds, configurations, documents,
# manual pages and completions of shells.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS troupe world-service robot-agent ros-participant RUNTIME)
install(TARGETS libtroupe troupe_controller_support EXPORT TroupeTargets)

if(TARGET python_package)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/python/troupe DESTINATION lib/python3/dist-packages COMPONENT python
    PATTERN __pycache__ EXCLUDE)
endif()

# The test public_headers_test compiles each of them without the tree.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/troupe DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Troupe)
set(TROUPE_WORLDS_DIR ${CMAKE_INSTALL_DATADIR}/troupe/worlds)
# Programs in the build folder find them as installed ones do (InstalledWorldsFolder).
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/troupe)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/worlds ${CMAKE_BINARY_DIR}/share/troupe/worlds SYMBOLIC)
# The WebAssembly module (preset wasm), where it was built (troupe view --static).
set(module_folder ${PROJECT_SOURCE_DIR}/build/wasm/bin)
file(CREATE_LINK ${module_folder} ${CMAKE_BINARY_DIR}/share/troupe/module SYMBOLIC)
install(DIRECTORY ${module_folder}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/troupe/module OPTIONAL)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/TroupeConfig.cmake.in
  ${CMAKE_BINARY_DIR}/package/TroupeConfig.cmake
  INSTALL_DESTINATION ${package_folder} PATH_VARS TROUPE_WORLDS_DIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/TroupeConfigVersion.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(EXPORT TroupeTargets NAMESPACE Troupe:: DESTINATION ${package_folder})
install(FILES ${CMAKE_BINARY_DIR}/package/TroupeConfig.cmake ${CMAKE_BINARY_DIR}/package/TroupeConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/troupe_controller.cmake DESTINATION ${package_folder})

install(DIRECTORY ${PROJECT_SOURCE_DIR}/worlds ${PROJECT_SOURCE_DIR}/configs
  DESTINATION ${CMAKE_INSTALL_DATADIR}/troupe)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN nav2 EXCLUDE)
# Its scenarios find the worlds as they do in the tree.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/nav2 ${PROJECT_SOURCE_DIR}/examples/ros_lockstep DESTINATION ${CMAKE_INSTALL_DATADIR}/troupe/examples)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

# Manual pages, from the programs' help texts. A subcommand that is missing here is found by the test installed_test.
set(pages)
list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)
function(troupe_manual_page program subcommand)
  set(page ${CMAKE_BINARY_DIR}/man/${program}.1)
  if(subcommand)
    set(page ${CMAKE_BINARY_DIR}/man/${program}-${subcommand}.1)
  endif()
  add_custom_command(OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/man
    COMMAND ${CMAKE_COMMAND} -E env "EMULATOR=${emulator}" ${PROJECT_SOURCE_DIR}/cmake/man_page $<TARGET_FILE:${program}> ${subcommand} > ${page}
    DEPENDS ${program} ${PROJECT_SOURCE_DIR}/cmake/man_page VERBATIM)
  list(APPEND pages ${page})
  set(pages ${pages} PARENT_SCOPE)
endfunction()
troupe_manual_page(troupe "")
foreach(subcommand run replay test sweep export check top view edit host loopback snapshot ctl goto teleop export-map export-views import-plan fleet keys
                   completions help)
  troupe_manual_page(troupe ${subcommand})
endforeach()
troupe_manual_page(world-service "")
troupe_manual_page(robot-agent "")
troupe_manual_page(ros-participant "")
add_custom_target(manual_pages ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

# Completions, where the packages of the shells look for them.
set(scripts)
foreach(place bash:bash-completion/completions/troupe zsh:zsh/vendor-completions/_troupe
              fish:fish/vendor_completions.d/troupe.fish)
  string(REGEX REPLACE ":.*" "" shell ${place})
  string(REGEX REPLACE ".*:" "" path ${place})
  set(script ${CMAKE_BINARY_DIR}/completions/${path})
  get_filename_component(folder ${script} DIRECTORY)
  add_custom_command(OUTPUT ${script}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND troupe completions ${shell} > ${script}
    DEPENDS troupe VERBATIM)
  list(APPEND scripts ${script})
endforeach()
add_custom_target(completions ALL DEPENDS ${scripts})
install(DIRECTORY ${CMAKE_BINARY_DIR}/completions/ DESTINATION ${CMAKE_INSTALL_DATADIR})

# The programs of a run, and no tests: for scripts/run.
add_custom_target(programs DEPENDS troupe world-service robot-agent ros-participant)
# All that is installed, and no tests: for scripts/package.
add_custom_target(installed DEPENDS libtroupe troupe_controller_support manual_pages completions)
add_dependencies(installed programs)
if(TARGET python_package)
  add_dependencies(installed python_package)
endif()
