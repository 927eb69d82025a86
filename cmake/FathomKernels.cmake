# SPDX-License-Identifier: Apache-2.0
# How kernels become numbers that a C++ file includes.

find_program(FATHOM_GLSLC glslc)
find_program(FATHOM_SPIRV_VAL spirv-val)

# fathom_embed_spirv(TARGET NAME SOURCE [OPTIONS...]): compiles SOURCE, a path in this repository, to
# NAME.spirv, a list of 32-bit numbers where the target's files find it.
function(fathom_embed_spirv target name source)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/spirv)
  set(command ${FATHOM_GLSLC} --target-env=vulkan1.1 -O -Werror ${ARGN}
    ${PROJECT_SOURCE_DIR}/${source})
  set(validate "")
  if(FATHOM_SPIRV_VAL)
    set(validate COMMAND ${FATHOM_SPIRV_VAL} --target-env vulkan1.1 ${folder}/${name}.spv)
  endif()
  add_custom_command(OUTPUT ${folder}/${name}.spirv
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND ${command} -MD -MF ${folder}/${name}.d -MT ${folder}/${name}.spirv -o ${folder}/${name}.spv
    ${validate}
    COMMAND ${command} -mfmt=num -o ${folder}/${name}.spirv
    DEPENDS ${PROJECT_SOURCE_DIR}/${source}
    DEPFILE ${folder}/${name}.d
    COMMENT "Kernel ${name}" VERBATIM)
  target_sources(${target} PRIVATE ${folder}/${name}.spirv)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()

# fathom_embed_text(TARGET FILE...): every kernels/FILE as FILE.text, a list of bytes where the target's
# files find it.
function(fathom_embed_text target)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/text)
  foreach(file IN LISTS ARGN)
    add_custom_command(OUTPUT ${folder}/${file}.text
      COMMAND ${CMAKE_COMMAND} -DFROM=${PROJECT_SOURCE_DIR}/kernels/${file} -DTO=${folder}/${file}.text
        -P ${PROJECT_SOURCE_DIR}/cmake/EmbedText.cmake
      DEPENDS ${PROJECT_SOURCE_DIR}/kernels/${file} ${PROJECT_SOURCE_DIR}/cmake/EmbedText.cmake
      COMMENT "Kernel text ${file}" VERBATIM)
    target_sources(${target} PRIVATE ${folder}/${file}.text)
  endforeach()
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
