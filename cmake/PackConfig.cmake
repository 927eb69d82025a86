# SPDX-License-Identifier: Apache-2.0
# Read by CPack as it begins: every package has a summary of its own, and not the project's in front of it.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
