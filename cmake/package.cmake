# The Debian package: `scripts/package`, or `cmake --build --preset release --target package`.
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
# The headers need Eigen's, and pictures a font.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, g++, openssh-client")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
include(CPack)
