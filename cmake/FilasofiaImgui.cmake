# Dear ImGui as Debian compiled it ends the process if an assertion fails. In our copy of the library an assertion calls
# filasofia_imgui_assertion() (src/filasofia/visual/imgui_surface.cpp), which throws: if a user's callback forgets the
# End of a Begin, an operation must not end. Included by FilasofiaDependencies.cmake, so it also holds for a user's
# build.
if(TARGET Filasofia::imgui)
  return()
endif()
find_library(FILASOFIA_IMGUI_LIBRARY NAMES libimgui.a REQUIRED)
find_path(FILASOFIA_IMGUI_INCLUDE imgui.h PATH_SUFFIXES imgui REQUIRED)
file(STRINGS ${FILASOFIA_IMGUI_INCLUDE}/imgui.h version REGEX "define IMGUI_VERSION  *\"")
if(NOT version MATCHES "\"1\\.86\"")
  message(FATAL_ERROR "The visual room is written for Dear ImGui 1.86 (it uses imgui_internal.h), but this version was found: ${version}")
endif()
if(NOT CMAKE_OBJCOPY)
  message(FATAL_ERROR "objcopy (from binutils) is needed to redirect ImGui's assertions")
endif()
set(library ${CMAKE_BINARY_DIR}/filasofia_imgui/libfilasofia_imgui.a)
if(NOT EXISTS ${library} OR ${FILASOFIA_IMGUI_LIBRARY} IS_NEWER_THAN ${library})
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/filasofia_imgui)
  execute_process(COMMAND ${CMAKE_OBJCOPY} --redefine-sym __assert_fail=filasofia_imgui_assertion
    ${FILASOFIA_IMGUI_LIBRARY} ${library} COMMAND_ERROR_IS_FATAL ANY)
endif()
add_library(Filasofia::imgui STATIC IMPORTED)
set_target_properties(Filasofia::imgui PROPERTIES IMPORTED_LOCATION ${library}
  INTERFACE_INCLUDE_DIRECTORIES ${FILASOFIA_IMGUI_INCLUDE} INTERFACE_LINK_LIBRARIES stb)
