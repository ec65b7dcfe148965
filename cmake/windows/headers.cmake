# Headers of Debian's packages for another system: a folder with links to those that are wanted, because
# all of /usr/include holds this system's own.

# palpate_headers(TARGET NAMES...): an interface target for headers below /usr/include.
function(palpate_headers target)
  if(TARGET ${target})
    return()
  endif()
  set(folder ${CMAKE_BINARY_DIR}/headers)
  file(MAKE_DIRECTORY ${folder})
  foreach(name ${ARGN})
    if(NOT EXISTS /usr/include/${name})
      message(FATAL_ERROR "/usr/include/${name} is missing: run scripts/install_packages.sh windows")
    endif()
    file(CREATE_LINK /usr/include/${name} ${folder}/${name} SYMBOLIC)
  endforeach()
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${folder}
                                             INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${folder})
endfunction()
