# Compiles each public header alone, with the installed headers only.
cmake_minimum_required(VERSION 3.25)
file(GLOB headers RELATIVE ${PREFIX}/include ${PREFIX}/include/troupe/*.h)
list(LENGTH headers count)
if(count EQUAL 0)
  message(FATAL_ERROR "no public header in ${PREFIX}/include/troupe")
endif()
file(MAKE_DIRECTORY ${FOLDER})
foreach(header IN LISTS headers)
  file(WRITE ${FOLDER}/alone.cc "#include \"${header}\"\n")
  execute_process(
    COMMAND ${COMPILER} -std=c++20 -Wall -Wextra -Wpedantic -Werror -fsyntax-only
      -I${PREFIX}/include -I${PREFIX}/include/troupe -isystem ${EIGEN} ${FOLDER}/alone.cc
    ERROR_VARIABLE errors RESULT_VARIABLE failed)
  if(failed)
    message(SEND_ERROR "${header} does not compile alone:\n${errors}")
  endif()
endforeach()
