# SPDX-License-Identifier: Apache-2.0
# Run by CPack before a package is closed: manual pages and changelogs are packed, as Debian has them.
# The name and the time of a file do not go into its packed form, so that packages come out alike.
find_program(gzip gzip REQUIRED)
file(GLOB_RECURSE papers ${CPACK_TEMPORARY_DIRECTORY}/*.[17] ${CPACK_TEMPORARY_DIRECTORY}/changelog.Debian)
list(FILTER papers INCLUDE REGEX "/share/(man|doc)/")
if(papers)
  execute_process(COMMAND ${gzip} -9nf ${papers} COMMAND_ERROR_IS_FATAL ANY)
endif()
