# Finds every third-party library once. All are Debian packages; scripts/setup.sh installs them. This file is also
# installed and read by FilasofiaConfig.cmake, so that a user's project finds the same libraries (or its own builds of
# them).
find_package(Threads REQUIRED)
find_package(assimp 5.2 REQUIRED CONFIG)
find_package(spdlog REQUIRED CONFIG)
if(FILASOFIA_WINDOW)
  find_package(SDL2 REQUIRED CONFIG)
endif()
find_package(hwy 1.0 REQUIRED CONFIG)
find_package(ZLIB REQUIRED)
find_package(pugixml REQUIRED CONFIG)
if(FILASOFIA_FILAMENT)
  find_package(filament 1.9 REQUIRED CONFIG)
endif()
# Debian's OpenSubdivConfig names a static library that the package does not contain, so the shared one is found here.
find_library(FILASOFIA_OSD_LIBRARY osdCPU REQUIRED)
find_path(FILASOFIA_OSD_INCLUDE opensubdiv/far/topologyRefiner.h REQUIRED)
if(NOT TARGET Filasofia::osd)
  add_library(Filasofia::osd SHARED IMPORTED)
  set_target_properties(Filasofia::osd PROPERTIES IMPORTED_LOCATION ${FILASOFIA_OSD_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${FILASOFIA_OSD_INCLUDE})
endif()
include(${CMAKE_CURRENT_LIST_DIR}/FilasofiaImgui.cmake)
