# Fails where a source on the way from a file to a state hash uses what differs between processors, compilers or standard
# libraries (docs/determinism.md, "Rules for portable bits").
#   cmake -DROOT=<source folder> -P portable_bits_test.cmake
cmake_minimum_required(VERSION 3.25)

# The folders from files of users to states, readings and recordings.
set(folders
  common/base common/geometry common/bitmap common/image common/model common/spatial common/sensing common/run
  include/troupe worldfile fleet transport/protocol transport/dds/convert transport/wire recording
  world-service/core world-service/replay
  robot-agent/controller robot-agent/drive robot-agent/gripper robot-agent/navigation robot-agent/robot
  testing/expectations library)

# Of a line: what comes before a place in code, which is not in a comment or a text.
set(code "^([^/\"]|/[^/]|\"[^\"]*\")*")
set(not_a_name "[^A-Za-z0-9_:.>\"]")

set(rules functions long unordered addresses)
# IEEE fixes + - * /, sqrt, remainder, fmod and roundings to a whole number; troupe/deterministic_math.h has the others.
set(name_of_functions "a function of <cmath> whose last bits each library chooses")
set(pattern_of_functions
  "${code}(${not_a_name}|std::|/ )(a?sinh?|a?cosh?|a?tanh?|atan2|exp|exp2|expm1|log|log2|log10|log1p|pow|hypot|cbrt|fma|erfc?|lgamma|tgamma)[fl]?\\([^)]")
# 64 bits on Linux, 32 on Windows and in WebAssembly; long long has 64 everywhere.
set(name_of_long "the type long, whose width differs")
set(pattern_of_long "${code}(^|[ (<])long( int)?[ >)&*]")
set(name_of_unordered "a hash table, whose order each library chooses")
set(pattern_of_unordered "${code}(std::unordered_|std::hash<)")
set(name_of_addresses "an order of addresses")
set(pattern_of_addresses "${code}std::(map|set|multimap|multiset|less|greater)<[^,>]*\\*[,>]")

# Where a function of C takes or gives a long, and where an order has no effect.
set(exceptions
  "long of common/image/bmp_reader.cc"    # fseek
  "long of common/image/jpeg_reader.cc"   # libjpeg
  "addresses of transport/protocol/memory_transport.cc"  # who is told first does not matter
  )

function(breaks rule line result)
  string(REPLACE "long long" "" line "${line}")
  set(${result} OFF PARENT_SCOPE)
  if(line MATCHES "${pattern_of_${rule}}")
    set(${result} ON PARENT_SCOPE)
  endif()
endfunction()

set(failures)
set(used)
set(count 0)
foreach(folder IN LISTS folders)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${folder}/*.h ${ROOT}/${folder}/*.cc)
  foreach(file IN LISTS files)
    math(EXPR count "${count} + 1")
    foreach(rule IN LISTS rules)
      file(STRINGS ${ROOT}/${file} lines REGEX "${pattern_of_${rule}}")
      set(breaking)
      foreach(line IN LISTS lines)
        breaks(${rule} "${line}" result)
        if(result)
          list(APPEND breaking "${line}")
        endif()
      endforeach()
      if(NOT breaking)
        continue()
      endif()
      if("${rule} of ${file}" IN_LIST exceptions)
        list(APPEND used "${rule} of ${file}")
      else()
        list(APPEND failures "${file}: ${name_of_${rule}}: ${breaking}")
      endif()
    endforeach()
  endforeach()
endforeach()

# Values of states and messages have a width. (Elsewhere Hasher::Add is ambiguous for a std::size_t of 32 bits, and the
# types in idl/ have widths.)
foreach(file include/troupe/world_state.h include/troupe/event.h transport/protocol/messages.h recording/recorded_run.h)
  file(STRINGS ${ROOT}/${file} lines REGEX "^  (std::vector<|std::optional<)?std::size_t>? [a-z_]+( = [^;]*)?;")
  if(lines)
    list(APPEND failures "${file}: a value of std::size_t, whose width differs: ${lines}")
  endif()
endforeach()

foreach(exception IN LISTS exceptions)
  if(NOT exception IN_LIST used)
    list(APPEND failures "${exception}: the exception is not needed any more")
  endif()
endforeach()
if(count LESS 200)
  list(APPEND failures "found only ${count} source files in ${ROOT}")
endif()

# The patterns find what they are for, and leave the rest.
set(found_functions "x = std::sin(a)" "  return a / cos(b)" "std::pow(10.0, y)" "std::hypotf(a, b)")
set(left_functions "SinCos(a)" "// std::sin(a)" "at.log(x)" "std::sqrt(x)" "Text(\"std::sin(a)\")" "double log() const")
set(found_long "unsigned long x = 0" "static_cast<long>(x)" "  long y" "f(long* p)")
set(left_long "static_cast<unsigned long long>(x)" "// so long as" "f(\"too long \")" "long long x" "  longest = 2")
set(found_unordered "std::unordered_map<int, int> m")
set(left_unordered "std::map<int, int> m")
set(found_addresses "std::map<const Scene*, int> m" "std::set<Body*> s")
set(left_addresses "std::map<int, const Scene*> m" "std::vector<Body*> s")
foreach(rule IN LISTS rules)
  foreach(line IN LISTS found_${rule})
    breaks(${rule} "${line}" result)
    if(NOT result)
      list(APPEND failures "the rule '${rule}' does not find: ${line}")
    endif()
  endforeach()
  foreach(line IN LISTS left_${rule})
    breaks(${rule} "${line}" result)
    if(result)
      list(APPEND failures "the rule '${rule}' finds: ${line}")
    endif()
  endforeach()
endforeach()

if(failures)
  list(JOIN failures "\n  " text)
  message(FATAL_ERROR "bits may differ between machines:\n  ${text}")
endif()
message(STATUS "the bits of ${count} files are portable")
