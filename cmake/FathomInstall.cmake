# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` gives to others: the program, one shared library made of all the folders,
# its headers, and the files by which CMake (find_package) and pkg-config find it.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# Every header that a user of the library may include; one that is not named here is private.
set(public_headers
  engine/backend.hpp engine/clock.hpp engine/colours.hpp engine/error.hpp engine/file.hpp engine/frame.hpp engine/metric.hpp
  engine/measure.hpp engine/one_thread.hpp engine/optics.hpp engine/scorer.hpp engine/selection.hpp
  engine/spectrum_picture.hpp engine/thin_lens_depth.hpp engine/travel.hpp engine/window.hpp engine/windowed_metric.hpp
  backends/backends.hpp
  pictures/picture.hpp
  hal/camera.hpp hal/finding.hpp hal/lens.hpp hal/motion.hpp hal/rig_driver.hpp hal/stop.hpp
  focus/auto_search.hpp focus/curve.hpp calibration/calibration.hpp calibration/choice.hpp
  calibration/curve.hpp calibration/fit.hpp calibration/likeness.hpp calibration/model.hpp
  calibration/range.hpp
  depth/align.hpp depth/mapper.hpp depth/maps.hpp depth/sharp.hpp depth/similarity.hpp depth/surfaces.hpp
  focus/blur.hpp focus/first_look.hpp focus/focus.hpp focus/light.hpp focus/moving_peak.hpp focus/noise.hpp focus/part_light.hpp
  focus/parts.hpp focus/peak.hpp focus/resemblance.hpp focus/sample.hpp focus/search.hpp focus/second_look.hpp
  focus/searches.hpp focus/spectral.hpp focus/spectral_fits.hpp focus/spectral_search.hpp
  focus/track.hpp focus/verdict.hpp
  session/lowest_coefficients.hpp session/measurement.hpp session/observer.hpp session/kept_surface.hpp session/passing.hpp session/picture_facts.hpp session/rig.hpp session/run.hpp session/run_file.hpp
  session/run_keeper.hpp session/ranging.hpp session/ring_reader.hpp session/session.hpp session/shot.hpp
  session/spectrum_keeper.hpp session/warning.hpp)

# The library is the objects of every folder: linking the archives alone would give nothing, because an
# archive only gives what somebody asks for. They are linked too for what they themselves need.
# Its target is not called `fathom`, because in the build folder that is the program.
add_library(fathom_shared SHARED)
add_library(fathom::fathom ALIAS fathom_shared)
foreach(folder IN ITEMS engine backends pictures hal focus calibration depth session capi)
  target_sources(fathom_shared PRIVATE $<TARGET_OBJECTS:fathom_${folder}>)
  target_link_libraries(fathom_shared PRIVATE fathom_${folder})
endforeach()
target_compile_features(fathom_shared INTERFACE cxx_std_20)
target_include_directories(fathom_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
set(export_list ${PROJECT_BINARY_DIR}/fathom.map)
list(TRANSFORM public_headers PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE header_files)
set(FATHOM_PUBLIC_HEADERS ${header_files})  # for a test
string(REPLACE ";" "|" header_argument "${header_files}")
add_custom_command(OUTPUT ${export_list}
  COMMAND ${CMAKE_COMMAND} -D OUTPUT=${export_list} -D C_HEADER=${PROJECT_SOURCE_DIR}/capi/fathom.h
          -D "HEADERS=${header_argument}" -P ${PROJECT_SOURCE_DIR}/cmake/ExportList.cmake
  DEPENDS ${header_files} capi/fathom.h cmake/ExportList.cmake
  COMMENT "Listing what libfathom.so shows"
  VERBATIM)
add_custom_target(fathom_export_list DEPENDS ${export_list})
add_dependencies(fathom_shared fathom_export_list)
target_link_options(fathom_shared PRIVATE -Wl,--version-script=${export_list})
if(NOT FATHOM_SANITIZE)  # The sanitizers' own symbols come from the program.
  target_link_options(fathom_shared PRIVATE -Wl,--no-undefined)
endif()
set_target_properties(fathom_shared PROPERTIES
  OUTPUT_NAME fathom
  EXPORT_NAME fathom
  LINKER_LANGUAGE CXX
  LINK_DEPENDS ${export_list}
  VERSION ${FATHOM_ABI}.${PROJECT_VERSION_MINOR}.${PROJECT_VERSION_PATCH}
  SOVERSION ${FATHOM_ABI})

install(TARGETS fathom_shared EXPORT fathomTargets
  LIBRARY COMPONENT library NAMELINK_COMPONENT development)
install(TARGETS fathom_cli RUNTIME COMPONENT program)
# Pages of man and completions of shells, which the program writes itself.
install(DIRECTORY ${FATHOM_MANUAL_DIR}/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program
  PATTERN zsh EXCLUDE)
set(zsh_dir site-functions)
if(CMAKE_INSTALL_PREFIX STREQUAL /usr)
  set(zsh_dir vendor-completions)  # where Debian's zsh looks for those of packages
endif()
install(FILES ${FATHOM_MANUAL_DIR}/zsh/site-functions/_fathom
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${zsh_dir} COMPONENT program)
set(umbrella "")
foreach(header IN LISTS public_headers)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fathom/${folder} COMPONENT development)
  string(APPEND umbrella "#include <fathom/${header}>\n")
endforeach()
install(FILES capi/fathom.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fathom COMPONENT development)

# <fathom.h> for C, and <fathom.hpp>, which is all headers of C++.
file(CONFIGURE OUTPUT include/fathom.h CONTENT
  "/* SPDX-License-Identifier: Apache-2.0 */\n#include <fathom/fathom.h>\n")
file(CONFIGURE OUTPUT include/fathom.hpp CONTENT
  "// SPDX-License-Identifier: Apache-2.0\n// All of Fathom for C++.\n#pragma once\n\n${umbrella}")
install(FILES ${PROJECT_BINARY_DIR}/include/fathom.h ${PROJECT_BINARY_DIR}/include/fathom.hpp
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)

# All that cmake --install copies, for those who build no more than that.
add_custom_target(installable DEPENDS fathom_cli fathom_shared fathom_manual)

# The pages refer to each other and to the examples, so the tree stays as it is.
set(doc_dir ${CMAKE_INSTALL_DATADIR}/doc/fathom-doc)
install(FILES README.md CHANGELOG.md DESTINATION ${doc_dir} COMPONENT documentation)
install(DIRECTORY docs examples DESTINATION ${doc_dir} COMPONENT documentation)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/fathom)
install(EXPORT fathomTargets NAMESPACE fathom:: DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(cmake/fathomConfig.cmake.in fathomConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(fathomConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/fathomConfig.cmake ${PROJECT_BINARY_DIR}/fathomConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT development)

# Relative to the file itself, so that an installed tree can be moved.
file(RELATIVE_PATH FATHOM_PREFIX_FROM_PKGCONFIG
  ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(cmake/fathom.pc.in fathom.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/fathom.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT development)
