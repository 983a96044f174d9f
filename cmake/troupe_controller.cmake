# For projects that use the installed package: troupe_controller(NAME SOURCES a.cc ...) builds a controller as the shared
# library NAME.so. See docs/controllers.md.
function(troupe_controller name)
  cmake_parse_arguments(arg "" "" "SOURCES" ${ARGN})
  add_library(${name} MODULE ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE Troupe::controller_support)
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()
