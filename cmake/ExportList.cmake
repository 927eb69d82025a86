# SPDX-License-Identifier: Apache-2.0
# Writes the version script of libfathom.so: what public headers declare is shown, all else is hidden.
#
#   cmake -D OUTPUT=FILE -D C_HEADER=FILE "-D HEADERS=FILE|FILE|..." -P ExportList.cmake
#
# A declaration starts in the first column of a line, as clang-format sees to.
string(REPLACE "|" ";" HEADERS "${HEADERS}")

# mangled(NAME... OUT): "optics" "Optics" is 6optics6Optics within fathom, as the Itanium ABI spells it.
function(mangled output)
  set(text "6fathom")
  foreach(part IN LISTS ARGN)
    string(LENGTH ${part} length)
    string(APPEND text ${length}${part})
  endforeach()
  set(${output} ${text} PARENT_SCOPE)
endfunction()

set(functions "")
set(classes "")
foreach(header IN LISTS HEADERS)
  set(space "")
  file(STRINGS ${header} lines REGEX "^(}  // namespace|namespace|class|struct|[A-Za-z][^={]*[ *&][a-z_][a-z_0-9]*\\()")
  foreach(line IN LISTS lines)
    if(line MATCHES "^namespace ([a-z]+) {" AND NOT CMAKE_MATCH_1 STREQUAL "fathom")
      set(space ${CMAKE_MATCH_1})
    elseif(line MATCHES "^}")
      set(space "")
    elseif(line MATCHES "^(class|struct) ([A-Za-z]+)( final)?( :| {)")
      mangled(name ${space} ${CMAKE_MATCH_2})
      list(APPEND classes ${name})
    elseif(line MATCHES "^(inline|constexpr|template|namespace|class|struct|enum|using)")
      continue()
    elseif(line MATCHES "[ *&]([a-z_][a-z_0-9]*)\\(")
      mangled(name ${space} ${CMAKE_MATCH_1})
      list(APPEND functions ${name})
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES functions)

set(text "/* Made by cmake/ExportList.cmake from the public headers. */\n{\n  global:\n")
file(STRINGS ${C_HEADER} lines REGEX "^FATHOM_API")
foreach(line IN LISTS lines)
  string(REGEX MATCH "(fathom_[a-z_]+)\\(" name "${line}")
  string(APPEND text "    ${CMAKE_MATCH_1};\n")
endforeach()
foreach(name IN LISTS functions)
  string(APPEND text "    _ZN${name}E*; _ZN${name}B5cxx11E*;\n")
endforeach()
foreach(name IN LISTS classes)  # members, and what exceptions and virtual functions need
  string(APPEND text "    _ZN${name}*; _ZNK${name}*; _ZTVN${name}E; _ZTIN${name}E; _ZTSN${name}E;\n")
endforeach()
string(APPEND text "  local:\n    *;\n};\n")
file(WRITE ${OUTPUT} "${text}")
