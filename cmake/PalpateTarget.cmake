# palpate_for_system(VARIABLE): from a list of sources, drops those of other systems. NAME_windows.cpp
# stands for NAME.cpp on Windows, and NAME.cpp for it elsewhere.
function(palpate_for_system variable)
  set(kept ${${variable}})
  foreach(source ${${variable}})
    if(source MATCHES "^(.+)_windows\\.cpp$")
      if(WIN32)
        list(REMOVE_ITEM kept ${CMAKE_MATCH_1}.cpp)
        # windows.h defines words such as far.
        set_property(SOURCE ${source} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
      else()
        list(REMOVE_ITEM kept ${source})
      endif()
    endif()
  endforeach()
  set(${variable} ${kept} PARENT_SCOPE)
endfunction()

# Compile options that every target of ours shares.
function(palpate_target name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  if(EMSCRIPTEN)  # it would go through a table
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  endif()
  # Same input, same output, bit for bit: no fused multiply-add behind the source's back.
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off)
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Warnings that depend on which sources are compiled together, and gcc's false alarm about
    # std::string (bug 105651). scripts/check_alone.py judges each source alone.
    target_compile_options(${name} PRIVATE -Wno-shadow -Wno-subobject-linkage -Wno-restrict)
  endif()
  if(PALPATE_WERROR)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
  if(PALPATE_SANITIZE)
    target_compile_options(${name} PRIVATE -fsanitize=${PALPATE_SANITIZE} -fno-omit-frame-pointer
                                           -fno-sanitize-recover=all)
    target_link_options(${name} PUBLIC -fsanitize=${PALPATE_SANITIZE})
    if(CMAKE_CXX_COMPILER_ID MATCHES Clang AND PALPATE_SANITIZE MATCHES undefined)
      # A vendor's library has its own names for the types of its interface.
      target_compile_options(${name} PRIVATE -fno-sanitize=function)
    endif()
  endif()
endfunction()

# palpate_unhurried(NAME): for code that tests run for seconds only. With the address sanitizer it is compiled
# with -O0, in half the time.
function(palpate_unhurried name)
  if(PALPATE_SANITIZE MATCHES address)
    target_compile_options(${name} PRIVATE -O0)
  endif()
endfunction()

# palpate_command_line(NAME): for code that reads options and starts others' work. gcc compiles it with -O1 in
# a quarter less time than with Release's -O3.
function(palpate_command_line name)
  target_compile_options(${name} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-O1>)
endfunction()

# palpate_fuzzed(NAME): the code that fuzz targets search through. Its comparisons and branches report
# to libFuzzer, which makes them slow; so this is for what reads foreign bytes only.
function(palpate_fuzzed name)
  if(PALPATE_FUZZ)
    target_compile_options(${name} PRIVATE -fsanitize=fuzzer-no-link)
    target_link_options(${name} PUBLIC -fsanitize=fuzzer-no-link)
  endif()
endfunction()
