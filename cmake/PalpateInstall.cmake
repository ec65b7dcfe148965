# What `cmake --install` leaves behind for other projects: headers, the core library and the CMake
# package `palpate`. The program and its reader process are installed by their own folders.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)

# 0.x may change the interface with every minor release, so that is what a shared library is named
# by and what find_package compares.
set_target_properties(palpate PROPERTIES
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/palpate DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT palpate-core FILES_MATCHING PATTERN "*.hpp")
install(TARGETS palpate EXPORT palpateTargets COMPONENT palpate-core)
install(EXPORT palpateTargets NAMESPACE palpate:: DESTINATION ${package_dir}
        COMPONENT palpate-core)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/palpateConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/palpateConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake
              ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT palpate-core)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT palpate-core)
