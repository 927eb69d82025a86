# SPDX-License-Identifier: Apache-2.0
# cmake -DFROM=FILE -DTO=FILE -P EmbedText.cmake: the bytes of a file as numbers that C++ includes.
file(READ ${FROM} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
file(WRITE ${TO} "${bytes}\n")
