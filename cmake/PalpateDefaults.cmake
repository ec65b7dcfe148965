# Defaults for a person who types `cmake -B build`. A project that takes Palpate in decides itself.
if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  find_program(PALPATE_CCACHE ccache)
  mark_as_advanced(PALPATE_CCACHE)
  if(PALPATE_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_C_COMPILER_LAUNCHER ${PALPATE_CCACHE})
    # Without these it does not cache what is compiled with precompiled headers.
    set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros ${PALPATE_CCACHE})
  endif()
  # lld takes a third of the time of ld, for a window's program an eighth. What is installed is linked by what
  # the system links with.
  find_program(PALPATE_LLD ld.lld)
  mark_as_advanced(PALPATE_LLD)
  if(PALPATE_LLD AND CMAKE_BUILD_TYPE STREQUAL "RelWithDebInfo" AND NOT CMAKE_CROSSCOMPILING)
    add_link_options(-fuse-ld=lld)
  endif()
endif()
if(PALPATE_FUZZ AND NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
  message(FATAL_ERROR "PALPATE_FUZZ needs clang for its libFuzzer: use the preset `asan`, or "
                      "configure an empty build directory with -DCMAKE_CXX_COMPILER=clang++.")
endif()
