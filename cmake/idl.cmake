# troupe_idl_library(NAME FILES a.idl ...): C types of the IDL files, made by Cyclone's idlc at build time.
function(troupe_idl_library name)
  cmake_parse_arguments(arg "" "" "FILES" ${ARGN})
  idlc_generate(TARGET ${name} FILES ${arg_FILES} WARNINGS no-implicit-extensibility)
endfunction()
