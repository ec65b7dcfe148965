# The Debian packages that CPack makes of the install rules (scripts/package.sh, docs/packages.md). What
# Debian wants beside the program's own files is in cmake/debian.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_VENDOR "The Palpate authors")
set(CPACK_PACKAGE_CONTACT "Palpate maintainers <maintainers@palpate.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PROJECT_CONFIG_FILE "")
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian/stage.cmake)
set(palpate_debian ${PROJECT_SOURCE_DIR}/cmake/debian)
set(version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

# palpate_package(GROUP NAME SECTION SUMMARY TEXT COMPONENTS...): the components that make a package.
set(palpate_packaged "")
function(palpate_package group name section summary text)
  string(TOUPPER ${group} GROUP)
  string(TOUPPER ${name} NAME)
  set(CPACK_DEBIAN_${GROUP}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${GROUP}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${GROUP}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
  set(CPACK_COMPONENT_GROUP_${GROUP}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
  foreach(component ${ARGN})
    string(TOUPPER ${component} COMPONENT)
    set(CPACK_COMPONENT_${COMPONENT}_GROUP ${group} PARENT_SCOPE)
  endforeach()
  set(palpate_packaged ${palpate_packaged} ${ARGN} PARENT_SCOPE)
endfunction()

set(about "Palpate computes the forces of an isosurface of CT, MRI or
microscopy data a thousand times a second, without extracting the
whole surface, and gives them to a haptic device.")

palpate_package(program palpate science "feel surfaces in volumetric data through a haptic device"
  "${about}
This package has the command line, the viewer, permissions for known
devices, and limits for real-time priority."
  palpate-program palpate-viewer)
# The picture helper opens EGL at run time.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "palpate-io-helper (= ${version}), libegl1")
# palpate evaluate, figures of reports
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "python3-palpate, python3-scipy, python3-matplotlib, gnuplot-nox")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS spacenavd)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA ${palpate_debian}/conffiles)

palpate_package(helper palpate-io-helper science "readers of volume files for Palpate"
  "${about}
This package has the program that reads and writes volume files for
the libraries and the command line, and sample data."
  palpate-io-helper)

palpate_package(shared libpalpate-c0 libs "feel surfaces in volumetric data (C interface)"
  "${about}
This package has the shared library for programs in C, C# and other
languages."
  palpate-c)
set(CPACK_DEBIAN_SHARED_PACKAGE_RECOMMENDS "palpate-io-helper (= ${version})")
# CPack's own shlibs come with maintainer scripts that a trigger makes needless.
configure_file(${palpate_debian}/shlibs.in ${PROJECT_BINARY_DIR}/shlibs @ONLY)
set(CPACK_DEBIAN_SHARED_PACKAGE_CONTROL_EXTRA ${palpate_debian}/triggers
                                              ${PROJECT_BINARY_DIR}/shlibs)

get_property(components GLOBAL PROPERTY palpate_components)
list(TRANSFORM components PREPEND palpate-)
palpate_package(development libpalpate-dev libdevel "feel surfaces in volumetric data (development files)"
  "${about}
This package has the headers for C and C++, the C++ libraries (static)
and the CMake package."
  ${components} palpate-c-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libpalpate-c0 (= ${version}), libblosc-dev, libcurl4-openssl-dev, libeigen3-dev, liblz4-dev, \
libzstd-dev, zlib1g-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "palpate-io-helper (= ${version})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)

# The Python module, where it is built: its install component is palpate-python.
if(TARGET palpate_python)
  palpate_package(python python3-palpate python "feel surfaces in volumetric data (Python)"
    "${about}
This package has the Python module."
    palpate-python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, palpate-io-helper (= ${version})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${palpate_debian}/python/postinst
                                                ${palpate_debian}/python/prerm)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-scipy, python3-matplotlib")  # palpate.evaluate
  # palpate.distributed and study, palpate.ros, report.pdf
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "libddsc0debian, python3-distributed, python3-rospy, weasyprint")
endif()

set(CPACK_COMPONENTS_ALL ${palpate_packaged})
include(CPack)
