# What `cmake --install` leaves behind: the CMake package `palpate`, with one component a library, and
# the programs. docs/package.md says what each component holds and what may change.
include(CMakePackageConfigHelpers)

set(palpate_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)

# palpate_rpath(TARGET FOLDER): where TARGET, installed in FOLDER, finds our shared libraries. Relative,
# so that the prefix can be moved.
function(palpate_rpath target folder)
  if(BUILD_SHARED_LIBS)
    file(RELATIVE_PATH libraries /prefix/${folder} /prefix/${CMAKE_INSTALL_LIBDIR})
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/${libraries}")
  endif()
endfunction()

# palpate_component(NAME TARGET HEADERS...): the library TARGET becomes palpate::NAME. HEADERS are
# paths below include/palpate: a folder, or a pattern of files.
function(palpate_component name target)
  # 0.x may change the interface with every minor release, so a shared library is named by both.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  palpate_rpath(${target} ${CMAKE_INSTALL_LIBDIR})
  if(NOT PALPATE_INSTALL)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY palpate_components ${name})
  set(component palpate-${name})
  install(TARGETS ${target} EXPORT ${component} COMPONENT ${component})
  install(EXPORT ${component} FILE palpate-${name}-targets.cmake NAMESPACE palpate::
          DESTINATION ${palpate_package_dir} COMPONENT ${component})
  foreach(headers ${ARGN})
    get_filename_component(folder ${headers} DIRECTORY)
    file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/palpate/${headers})
    install(FILES ${files} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/palpate/${folder}
            COMPONENT ${component})
  endforeach()
endfunction()

# palpate_program(TARGET COMPONENT): a program that people start.
function(palpate_program target component)
  palpate_rpath(${target} ${CMAKE_INSTALL_BINDIR})
  if(PALPATE_INSTALL)
    install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  endif()
endfunction()

# palpate_helper(TARGET COMPONENT): a program that our libraries start. io/process/helper_folders.cpp looks for
# it; in a build tree all of them are in one folder.
set(palpate_helper_dir ${PROJECT_BINARY_DIR}/libexec/palpate)
function(palpate_helper target component)
  set(folder ${CMAKE_INSTALL_LIBEXECDIR}/palpate)
  palpate_rpath(${target} ${folder})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${palpate_helper_dir})
  if(PALPATE_INSTALL)
    install(TARGETS ${target} RUNTIME DESTINATION ${folder} COMPONENT ${component})
  endif()
endfunction()

# palpate_built_helper(TARGET PROGRAM): the helper that another build has, in the folder PALPATE_HELPERS. It is
# not installed.
function(palpate_built_helper target program)
  if(NOT EXISTS ${PALPATE_HELPERS}/${program})
    message(FATAL_ERROR "PALPATE_HELPERS: no ${program} in ${PALPATE_HELPERS}; build it there first")
  endif()
  add_executable(${target} IMPORTED GLOBAL)
  set_target_properties(${target} PROPERTIES IMPORTED_LOCATION ${PALPATE_HELPERS}/${program})
  file(MAKE_DIRECTORY ${palpate_helper_dir})
  file(CREATE_LINK ${PALPATE_HELPERS}/${program} ${palpate_helper_dir}/${program} SYMBOLIC)
endfunction()

if(PALPATE_INSTALL)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/palpateConfig.cmake.in
                                ${PROJECT_BINARY_DIR}/palpateConfig.cmake
                                INSTALL_DESTINATION ${palpate_package_dir}
                                PATH_VARS CMAKE_INSTALL_LIBEXECDIR
                                NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake
                ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
                ${PROJECT_SOURCE_DIR}/cmake/helper_folder.cpp.in
          DESTINATION ${palpate_package_dir} COMPONENT palpate-core)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}
          COMPONENT palpate-core)
endif()
