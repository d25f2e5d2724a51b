# The content of `cmake --install`: one static library per room, the public headers, the program, the meshes, and the
# package that find_package(Filasofia) reads. Included last, after every room has registered itself.
include(CMakePackageConfigHelpers)
set(FILASOFIA_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Filasofia)

# Filasofia::filasofia links every room. The program's target is already called filasofia, so this target has another
# name here.
get_property(rooms GLOBAL PROPERTY FILASOFIA_ROOM_TARGETS)
add_library(filasofia_all INTERFACE)
add_library(Filasofia::filasofia ALIAS filasofia_all)
set_target_properties(filasofia_all PROPERTIES EXPORT_NAME filasofia)
target_link_libraries(filasofia_all INTERFACE ${rooms})

# If a project adds this one as a subdirectory, it installs only its own files.
option(FILASOFIA_INSTALL "Let cmake --install put the libraries, headers and program in place" ${PROJECT_IS_TOP_LEVEL})
if(NOT FILASOFIA_INSTALL)
  return()
endif()

# The Python package can be built with the libraries of this build folder (bindings/python).
export(TARGETS ${rooms} filasofia_all filasofia_flags NAMESPACE Filasofia:: FILE ${PROJECT_BINARY_DIR}/FilasofiaBuildTargets.cmake)
file(WRITE ${PROJECT_BINARY_DIR}/FilasofiaBuildOptions.cmake 
  "set(FILASOFIA_FILAMENT ${FILASOFIA_FILAMENT})\nset(FILASOFIA_WINDOW ${FILASOFIA_WINDOW})\nset(FILASOFIA_SOFA ${FILASOFIA_HAS_SOFA})\n")

install(TARGETS ${rooms} filasofia_all EXPORT FilasofiaTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/filasofia DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h
  PATTERN testing EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/meshes DESTINATION ${CMAKE_INSTALL_DATADIR}/filasofia)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/filasofia)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/motions DESTINATION ${CMAKE_INSTALL_DATADIR}/filasofia)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/thumbnails DESTINATION ${CMAKE_INSTALL_DATADIR}/filasofia)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/fonts DESTINATION ${CMAKE_INSTALL_DATADIR}/filasofia) # its licence
install(FILES ${PROJECT_SOURCE_DIR}/assets/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/filasofia) # the meshes' terms
foreach(program filasofia hysteroscopy laparoscopy)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()

install(EXPORT FilasofiaTargets NAMESPACE Filasofia:: DESTINATION ${FILASOFIA_PACKAGE_DIR})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/FilasofiaConfig.cmake.in
  ${PROJECT_BINARY_DIR}/FilasofiaConfig.cmake INSTALL_DESTINATION ${FILASOFIA_PACKAGE_DIR}
  PATH_VARS CMAKE_INSTALL_DATADIR)
# Below 1.0 a minor version may break its callers.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/FilasofiaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/FilasofiaConfig.cmake ${PROJECT_BINARY_DIR}/FilasofiaConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FilasofiaDependencies.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FilasofiaImgui.cmake ${PROJECT_SOURCE_DIR}/cmake/FilasofiaSofa.cmake DESTINATION ${FILASOFIA_PACKAGE_DIR})
