# troupe_idl_library(NAME [NO_TYPE_INFO] FILES a.idl ...): the C types of IDL files, made by Cyclone's idlc at build
# time, as a static library. The generated header of idl/frame.idl is "idl/frame.h".
function(troupe_idl_library name)
  cmake_parse_arguments(arg "NO_TYPE_INFO" "" "FILES" ${ARGN})
  set(options)
  if(arg_NO_TYPE_INFO)
    set(options NO_TYPE_INFO)
  endif()
  idlc_generate(TARGET ${name}_types ${options} BASE_DIR ${PROJECT_SOURCE_DIR} FILES ${arg_FILES}
    WARNINGS no-implicit-extensibility)
  add_library(${name} STATIC)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PRIVATE ${name}_types PUBLIC CycloneDDS::ddsc)
  target_include_directories(${name} SYSTEM PUBLIC ${CMAKE_CURRENT_BINARY_DIR})
  add_dependencies(${name} ${name}_types_generate)
endfunction()

# troupe_idl_texts(VARIABLE): sets it to a source with the IDL files of recordings' messages, for their schemas.
function(troupe_idl_texts variable)
  set(files frame.idl proposal.idl recorded_edit.idl recorded_run.idl recorded_tick.idl)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/idl_texts.cc)
  # Made when CMake runs, because the tools that read all sources build nothing.
  file(GLOB all_idl ${PROJECT_SOURCE_DIR}/idl/*.idl)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${all_idl} ${PROJECT_SOURCE_DIR}/cmake/embed_idl.cmake)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${PROJECT_SOURCE_DIR}/idl "-DFILES=${files}" -DOUTPUT=${source}
      -P ${PROJECT_SOURCE_DIR}/cmake/embed_idl.cmake
    COMMAND_ERROR_IS_FATAL ANY)
  set(${variable} ${source} PARENT_SCOPE)
endfunction()
