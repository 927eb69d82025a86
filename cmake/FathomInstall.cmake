# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` gives to others: the program, one shared library made of all the folders,
# its headers, and the files by which CMake (find_package) and pkg-config find it.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# Every header that a user of the library may include; one that is not named here is private.
set(public_headers
  engine/backend.hpp engine/clock.hpp engine/error.hpp engine/file.hpp engine/frame.hpp engine/metric.hpp
  engine/measure.hpp engine/optics.hpp engine/scorer.hpp engine/selection.hpp
  engine/spectrum_picture.hpp engine/travel.hpp engine/window.hpp engine/windowed_metric.hpp
  backends/backends.hpp
  pictures/picture.hpp
  hal/camera.hpp hal/lens.hpp hal/motion.hpp hal/rig_driver.hpp hal/stop.hpp
  focus/auto_search.hpp focus/curve.hpp calibration/calibration.hpp calibration/choice.hpp
  calibration/curve.hpp calibration/fit.hpp calibration/model.hpp calibration/range.hpp
  focus/focus.hpp focus/noise.hpp focus/peak.hpp focus/search.hpp focus/searches.hpp
  focus/track.hpp focus/verdict.hpp
  session/measurement.hpp session/observer.hpp session/rig.hpp session/run.hpp session/run_file.hpp
  session/run_keeper.hpp session/session.hpp session/shot.hpp session/warning.hpp)

# The library is the objects of every folder: linking the archives alone would give nothing, because an
# archive only gives what somebody asks for. They are linked too for what they themselves need.
# Its target is not called `fathom`, because in the build folder that is the program.
add_library(fathom_shared SHARED)
add_library(fathom::fathom ALIAS fathom_shared)
foreach(folder IN ITEMS engine backends pictures hal focus calibration session capi)
  target_sources(fathom_shared PRIVATE $<TARGET_OBJECTS:fathom_${folder}>)
  target_link_libraries(fathom_shared PRIVATE fathom_${folder})
endforeach()
target_compile_features(fathom_shared INTERFACE cxx_std_20)
target_include_directories(fathom_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
set(export_list ${PROJECT_SOURCE_DIR}/cmake/fathom.map)
target_link_options(fathom_shared PRIVATE -Wl,--version-script=${export_list})
if(NOT FATHOM_SANITIZE)  # The sanitizers' own symbols come from the program.
  target_link_options(fathom_shared PRIVATE -Wl,--no-undefined)
endif()
set_target_properties(fathom_shared PROPERTIES
  OUTPUT_NAME fathom
  EXPORT_NAME fathom
  LINKER_LANGUAGE CXX
  LINK_DEPENDS ${export_list}
  VERSION ${PROJECT_VERSION}
  # Before 1.0 every minor version may change the interface.
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

install(TARGETS fathom_shared EXPORT fathomTargets)
install(TARGETS fathom_cli)
foreach(header IN LISTS public_headers)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fathom/${folder})
endforeach()
install(FILES capi/fathom.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fathom)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/fathom)
install(EXPORT fathomTargets NAMESPACE fathom:: DESTINATION ${package_dir})
configure_package_config_file(cmake/fathomConfig.cmake.in fathomConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(fathomConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/fathomConfig.cmake ${PROJECT_BINARY_DIR}/fathomConfigVersion.cmake
  DESTINATION ${package_dir})

# Relative to the file itself, so that an installed tree can be moved.
file(RELATIVE_PATH FATHOM_PREFIX_FROM_PKGCONFIG
  ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(cmake/fathom.pc.in fathom.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/fathom.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
