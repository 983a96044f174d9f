# Flags of every target. -ffp-contract=off: a fused multiply-add rounds once where two operations round twice,
# so letting the compiler choose would give other bits on other machines.
add_library(troupe_options INTERFACE)
target_compile_options(troupe_options INTERFACE
  -ffp-contract=off -fno-fast-math
  -Wall -Wextra -Wpedantic -Wno-overlength-strings -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wunused
  $<$<BOOL:${TROUPE_WERROR}>:-Werror>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # These have false positives in libstdc++'s own string concatenation, depending on the length of a literal
  # (https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105651): they warn, but never fail a build.
  target_compile_options(troupe_options INTERFACE
    -Wno-error=array-bounds -Wno-error=maybe-uninitialized -Wno-error=restrict -Wno-error=stringop-overflow -Wno-error=stringop-overread)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Without garbage collections of the compiler before it has 1 GiB, a compilation takes a sixth less time.
  target_compile_options(troupe_options INTERFACE --param=ggc-min-expand=100 --param=ggc-min-heapsize=1048576)
endif()
# Most of a compilation goes into headers, so several sources are compiled as one where all of them are compiled anyway:
# in the presets release and ci. Not in dev, where one changed source is to cost one compilation and a missing include
# is to be found.
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A class of a source may have members of types of that source, a class of a header may not: here they are the same file.
  target_compile_options(troupe_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
endif()
target_include_directories(troupe_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)

if(TROUPE_SANITIZER)
  target_compile_options(troupe_options INTERFACE -fsanitize=${TROUPE_SANITIZER} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  if(TROUPE_SANITIZER MATCHES undefined)
    # These look at each access, a quarter of the time of a build: the first faults without a check, too, sizes are looked
    # at by the address sanitizer, and x86 has no alignment.
    target_compile_options(troupe_options INTERFACE -fno-sanitize=null,object-size,alignment,vptr)
  endif()
  target_link_options(troupe_options INTERFACE -fsanitize=${TROUPE_SANITIZER})
  if(TROUPE_SANITIZER STREQUAL thread)
    # Linked as C, so that the sanitizer's operators new and delete, which are not weak, stay out: programs with shared
    # memory have their own (transport/shared_memory/shared_arena.cc). It sees malloc and free.
    target_link_options(troupe_options INTERFACE --driver-mode=gcc)
    target_link_libraries(troupe_options INTERFACE stdc++ m)
  endif()
  target_compile_definitions(troupe_options INTERFACE TROUPE_SANITIZED)  # each compiler has a macro of its own
endif()

if(TROUPE_ONE_LINK)
  # scripts/odr links the sources of all programs as one, so each program's main needs a name of its own.
  target_compile_definitions(troupe_options INTERFACE main=main_of_$<MAKE_C_IDENTIFIER:$<TARGET_PROPERTY:NAME>>)
endif()

if(TROUPE_FUZZ)
  # Counts coverage in all code that a fuzz target links.
  target_compile_options(troupe_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
