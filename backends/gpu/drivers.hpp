// SPDX-License-Identifier: Apache-2.0
// Who the drivers of this machine are, without starting them: a change of any of their files, or of
// what leads to them, changes the text.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::gpu {

/// Path, size, time of the last change and inode; "PATH -" where there is no such file.
std::string file_identity(const std::filesystem::path& path);

/// The same of every file in a folder whose name ends so, by name; and of the libraries that these
/// files name, where they are found (library_named()). Empty where there is no such folder.
std::string folder_identity(const std::filesystem::path& folder, std::string_view ending);

/// The library of a manifest: of "library_path" in a JSON file, of the first line of any other.
/// As it stands there if it is a path, relative to the manifest or absolute; found in the linker's
/// usual folders if it is a name. Empty if there is none.
std::filesystem::path library_named(const std::filesystem::path& manifest);

/// Where a function lives: the library that is loaded already, such as a loader of drivers.
std::string library_identity(const void* function);

/// What every driver depends on: the running kernel, the linker's cache, which changes with every
/// library that is installed, the device files that there are and may be used, and the variables
/// that drivers and loaders obey.
std::string machine_identity();

/// The paths in a variable, separated by colons.
std::vector<std::filesystem::path> paths_in(const char* variable);

}  // namespace fathom::gpu
