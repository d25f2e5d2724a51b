#pragma once

#include <string>
#include <vector>

namespace filasofia::runtime {

/// The data folder of the installed Filasofia that find_package() found, wherever it was moved to; else empty.
#ifdef FILASOFIA_DATA_DIR
constexpr const char* kInstalledData = FILASOFIA_DATA_DIR;
#else
constexpr const char* kInstalledData = "";
#endif

/// The path of a file that comes with Filasofia, such as "meshes/bunny_3004.msh". Looks in the folder that the
/// environment variable FILASOFIA_ASSETS names, in share/filasofia beside the running program's folder, in `installed`
/// (unless empty), in the source tree that this library was built from, and in the folder it was to be installed in.
/// Throws an Error naming these folders if none has the file.
std::string asset(const std::string& name, const std::string& installed = kInstalledData);

/// The files of a type, such as ".json", in a folder of assets, such as "cases/hysteroscopy", by their names. Where
/// several of the places above have one of the same name, it is that which asset() finds.
std::vector<std::string> assetsIn(const std::string& folder, const std::string& type,
                                  const std::string& installed = kInstalledData);

} // namespace filasofia::runtime
