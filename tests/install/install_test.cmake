# cmake -D WAY=consumer|subproject ... -P install_test.cmake: copies that project out of the tree, then configures,
# builds and runs it, either against an installed Filasofia or with Filasofia as its subdirectory. Stops at the first
# step that fails.
set(place ${FILASOFIA_BUILD}/tests/install/${WAY}_test)
set(prefix ${place}/prefix)

function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed)
  if(failed)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "this command failed (${failed}): ${command}")
  endif()
endfunction()

function(expect_file path)
  if(NOT EXISTS ${path})
    message(FATAL_ERROR "not installed: ${path}")
  endif()
endfunction()

file(REMOVE_RECURSE ${place})
file(COPY ${FILASOFIA_SOURCE}/tests/install/${WAY}/ DESTINATION ${place}/source)

if(WAY STREQUAL consumer)
  step(${CMAKE_COMMAND} --install ${FILASOFIA_BUILD} --prefix ${place}/first)
  file(RENAME ${place}/first ${prefix}) # an installed package may be moved
  expect_file(${prefix}/bin/filasofia)
  expect_file(${prefix}/include/filasofia/core/error.h)
  expect_file(${prefix}/share/filasofia/README.md)
  file(GLOB source_meshes RELATIVE ${FILASOFIA_SOURCE}/assets/meshes ${FILASOFIA_SOURCE}/assets/meshes/*)
  foreach(mesh IN LISTS source_meshes)
    expect_file(${prefix}/share/filasofia/meshes/${mesh})
  endforeach()
  set(where -D CMAKE_PREFIX_PATH=${prefix} -D EXPECTED_VERSION=${VERSION})
else()
  set(where -D FILASOFIA_SOURCE=${FILASOFIA_SOURCE})
endif()

step(${CMAKE_COMMAND} -S ${place}/source -B ${place}/build -G Ninja -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
  -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} ${where})
step(${CMAKE_COMMAND} --build ${place}/build)
# The meshes must come from the package, at its present location.
unset(ENV{FILASOFIA_ASSETS})
step(${place}/build/outside ${prefix}/)
