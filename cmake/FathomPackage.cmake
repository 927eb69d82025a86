# SPDX-License-Identifier: Apache-2.0
# What tools/package makes with CPack: Debian packages by component, and a tarball of all but Python.
set(CPACK_PACKAGE_NAME fathom)
set(CPACK_PACKAGE_VENDOR "Fathom")
# Domains that end in .example are reserved: mail to this one reaches nobody, and nobody by mistake.
set(FATHOM_MAINTAINER "Fathom maintainers <maintainers@fathom.example>" CACHE STRING "Who made the packages")
set(CPACK_PACKAGE_CONTACT "${FATHOM_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_FILE_NAME "fathom-${PROJECT_VERSION}-linux-${CMAKE_SYSTEM_PROCESSOR}")
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 1)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program library development documentation)
if(FATHOM_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python_package)
endif()

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The library of this build is found without being installed.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(FATHOM_DEB_VERSION "${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")

# debian_package(COMPONENT NAME SECTION SUMMARY TEXT): the text is wrapped at 79 columns by hand.
macro(debian_package component name section summary text)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${summary}\n${text}")
endmacro()

debian_package(program fathom science "measure focus, and from focus, distance"
"Fathom scores how sharp a window of a picture is, by the moment of inertia of
its Fourier or Walsh spectrum, moves a lens to where it is sharpest, and turns
the lens position into a distance with its uncertainty.
.
This package has the program with its manual pages.")
# GPUs, machine-vision cameras and plots are looked for when they are asked for, and are done without.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS
  "libvulkan1, mesa-vulkan-drivers | vulkan-icd, ocl-icd-libopencl1 | libopencl1, libaravis-0.8-0, gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "indi-bin, v4l-utils, fathom-doc, python3-fathom")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_GENERATE_SHLIBS OFF)

debian_package(library libfathom${FATHOM_ABI} libs "measure focus, and from focus, distance: library"
"Fathom scores how sharp a window of a picture is, searches a lens for its
focus, and turns the lens position into a distance with its uncertainty.
.
This package has the shared library for C++ and C.")
file(CONFIGURE OUTPUT papers/triggers CONTENT "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/papers/triggers)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "libvulkan1, ocl-icd-libopencl1 | libopencl1, libaravis-0.8-0")

debian_package(development libfathom-dev libdevel "measure focus, and from focus, distance: headers"
"Fathom scores how sharp a window of a picture is, searches a lens for its
focus, and turns the lens position into a distance with its uncertainty.
.
This package has what programs in C++ and C are built with: headers, and the
files of CMake and pkg-config.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libfathom${FATHOM_ABI} (= ${FATHOM_DEB_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "fathom-doc")

debian_package(documentation fathom-doc doc "measure focus, and from focus, distance: documentation"
"Fathom scores how sharp a window of a picture is, searches a lens for its
focus, and turns the lens position into a distance with its uncertainty.
.
This package has its pages and the examples.")
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)

debian_package(python_package python3-fathom python "measure focus, and from focus, distance: Python 3"
"Fathom scores how sharp a window of a picture is, searches a lens for its
focus, and turns the lens position into a distance with its uncertainty.
.
This package has the module for Python, which takes arrays of numpy in place.")
set(next_python 0)
if(FATHOM_PYTHON)
  math(EXPR next_python "${Python_VERSION_MINOR} + 1")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_PACKAGE_DEPENDS
  "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_python}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_PACKAGE_RECOMMENDS
  "libvulkan1, ocl-icd-libopencl1 | libopencl1, libaravis-0.8-0, python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_PACKAGE_SUGGESTS
  "python3-dask, python3-distributed, python3-tifffile, python3-zarr, python3-xarray")
set(CPACK_DEBIAN_PYTHON_PACKAGE_PACKAGE_GENERATE_SHLIBS OFF)
set(scripts ${PROJECT_SOURCE_DIR}/packaging/debian/python3-fathom)
set(CPACK_DEBIAN_PYTHON_PACKAGE_PACKAGE_CONTROL_EXTRA ${scripts}/postinst ${scripts}/prerm)

# Every package has its papers, as Debian wants them; pages are packed when the packages are.
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} key)
  set(name ${CPACK_DEBIAN_${key}_PACKAGE_NAME})
  set(papers ${PROJECT_BINARY_DIR}/papers/${name})
  file(CONFIGURE OUTPUT ${papers}/changelog.Debian @ONLY CONTENT
"fathom (@FATHOM_DEB_VERSION@) unstable; urgency=medium

  * Version @PROJECT_VERSION@; CHANGELOG.md of fathom-doc says what is new.

 -- @CPACK_PACKAGE_CONTACT@  @FATHOM_RELEASE_DATE@
")
  file(STRINGS ${PROJECT_SOURCE_DIR}/packaging/debian/overrides lines)
  set(overrides "")
  foreach(line IN LISTS lines)
    if(line AND NOT line MATCHES "^#")
      string(PREPEND line "${name}: ")
    endif()
    string(APPEND overrides "${line}\n")
  endforeach()
  file(CONFIGURE OUTPUT ${papers}/${name} CONTENT "${overrides}")
  install(FILES ${papers}/changelog.Debian ${PROJECT_SOURCE_DIR}/packaging/debian/copyright
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${papers}/${name}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/PackConfig.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/PackPapers.cmake)
include(CPack)
