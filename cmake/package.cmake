# The Debian packages, troupe and python3-troupe: `scripts/package`, or `cmake --build --preset release --target package`.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME troupe)
set(CPACK_PACKAGE_CONTACT "Troupe maintainers <maintainers@troupe.invalid>")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# The text below the first line, which is the project's description.
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "A world service arbitrates all collisions and grasps; each robot is a process of its own, on this or another machine,
and exchanges its state over DDS in lockstep ticks. The package holds the programs, the library libtroupe with its
headers and CMake package, worlds, configurations and manual pages.")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
# The headers need Eigen's, and pictures a font.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, g++, mosquitto, openssh-client")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
# All that has no component is the package troupe.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME troupe)
if(TARGET python_package)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-troupe)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Troupe for Python: worlds as arrays of numpy, many worlds at once, and robot controllers
as classes in Python.")
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
  math(EXPR next_minor "${TROUPE_PYTHON_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "troupe (= ${PROJECT_VERSION}), python3-numpy, python3 (>= 3.${TROUPE_PYTHON_MINOR}), python3 (<< 3.${next_minor})")
endif()
include(CPack)
