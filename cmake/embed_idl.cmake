# Writes a C++ source with the texts of IDL files, each with the files that it includes, so that it is complete by itself.
#   cmake -DFOLDER=<idl> -DFILES=<a.idl;b.idl> -DOUTPUT=<source.cc> -P embed_idl.cmake
# The source defines: const IdlText kIdlTexts[] of recording/recorded_run.h.
cmake_minimum_required(VERSION 3.25)

# Appends the lines of a file to `text`, and those of each file that it includes once, in the caller.
function(append_idl name)
  if(name IN_LIST included)
    return()
  endif()
  list(APPEND included ${name})
  file(READ ${FOLDER}/${name} content)
  string(REGEX REPLACE "#(ifndef|define|endif)[^\n]*\n" "" content "${content}")  # each file is included once
  while(content MATCHES "#include \"([^\"]*)\"\n")
    set(include ${CMAKE_MATCH_1})
    string(REPLACE "#include \"${include}\"\n" "" content "${content}")
    append_idl(${include})
  endwhile()
  string(APPEND text "${content}")
  set(text "${text}" PARENT_SCOPE)
  set(included "${included}" PARENT_SCOPE)
endfunction()

set(source "// Made by cmake/embed_idl.cmake.\n#include \"recording/recorded_run.h\"\n\nnamespace troupe {\n\n")
string(APPEND source "const IdlText kIdlTexts[] = {\n")
foreach(file IN LISTS FILES)
  set(text "")
  set(included "")
  append_idl(${file})
  string(APPEND source "    {\"${file}\", R\"IDL(${text})IDL\"},\n")
endforeach()
string(APPEND source "};\nconst std::size_t kIdlTextCount = sizeof kIdlTexts / sizeof kIdlTexts[0];\n\n}  // namespace troupe\n")

# A file that is the same keeps its time, so that it is not compiled again.
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT before STREQUAL source)
  file(WRITE ${OUTPUT} "${source}")
endif()
