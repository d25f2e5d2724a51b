# The flags that all targets share, and the two functions that define a room and a room's tests.

set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # DEPEND: sources are equal if all their bytes are. Without it, a precompiled header comes from the cache although a comment
  # has changed in what it includes, and GCC then reads that header again in spite of its #pragma once.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_DEPEND=1
    ${CCACHE_PROGRAM})
endif()
find_package(Threads REQUIRED)

# Same input, same bits: no contraction of a*b+c and no -ffast-math, on any compiler.
add_library(filasofia_flags INTERFACE)
target_compile_features(filasofia_flags INTERFACE cxx_std_20)
target_compile_options(filasofia_flags INTERFACE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
  -Woverloaded-virtual $<$<BOOL:${FILASOFIA_WERROR}>:-Werror>)
if(FILASOFIA_SANITIZE)
  # GCC 12 sees uninitialized members in its own <regex> once sanitized (gcc.gnu.org/PR105562).
  target_compile_options(filasofia_flags INTERFACE -fsanitize=${FILASOFIA_SANITIZE} -fno-omit-frame-pointer
    $<$<CXX_COMPILER_ID:Clang>:-fno-sanitize-recover=all> $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  if(FILASOFIA_NO_SANITIZE)
    target_compile_options(filasofia_flags INTERFACE -fno-sanitize=${FILASOFIA_NO_SANITIZE})
  endif()
  target_link_options(filasofia_flags INTERFACE -fsanitize=${FILASOFIA_SANITIZE})
endif()
if(FILASOFIA_FEWER_CASES AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  # Highway leaves out what is below the baseline, here its plain code: sanitized, that took most of the time to compile the
  # inner loops. It runs in the preset release, and under the sanitizers in asan-all.
  target_compile_options(filasofia_flags INTERFACE -msse4.2 -maes -mpclmul)
endif()

# CMAKE_UNITY_BUILD (presets release, asan, asan-all, tsan) compiles the sources of a target in batches, so that their headers
# are read once per batch. GCC warns of any class in a source that is not the first one of its batch and holds a member
# of an anonymous namespace.
if(CMAKE_UNITY_BUILD)
  target_compile_options(filasofia_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()

# Sources that cannot share a batch: Highway's, which include themselves once per instruction set, X11's macros, and
# programs whose helpers share names on purpose.
function(filasofia_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# filasofia_room(geometry SOURCES a.cpp b.cpp DEPENDS core math VENDORS assimp::assimp)
function(filasofia_room name)
  cmake_parse_arguments(ROOM "NOT_INSTALLED" "" "SOURCES;DEPENDS;VENDORS;PRECOMPILE" ${ARGN})
  add_library(filasofia_${name} STATIC ${ROOM_SOURCES})
  add_library(Filasofia::${name} ALIAS filasofia_${name})
  target_include_directories(filasofia_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/generated)
  target_compile_features(filasofia_${name} PUBLIC cxx_std_20)
  list(TRANSFORM ROOM_DEPENDS PREPEND filasofia_)
  target_link_libraries(filasofia_${name} PUBLIC ${ROOM_DEPENDS} Threads::Threads
    PRIVATE $<BUILD_INTERFACE:filasofia_flags> ${ROOM_VENDORS})
  set_target_properties(filasofia_${name} PROPERTIES EXPORT_NAME ${name} CXX_EXTENSIONS OFF
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON POSITION_INDEPENDENT_CODE ON)
  if(ROOM_PRECOMPILE AND FILASOFIA_PRECOMPILE)
    target_precompile_headers(filasofia_${name} PRIVATE ${ROOM_PRECOMPILE})
  endif()
  if(NOT ROOM_NOT_INSTALLED)
    set_property(GLOBAL APPEND PROPERTY FILASOFIA_ROOM_TARGETS filasofia_${name})
  endif()
endfunction()

# filasofia_tests(geometry SOURCES mesh_test.cpp ... LINKS extra): one program, one ctest entry per TEST_CASE.
# The tests see the private headers of their room. LONG: some have the tag [long] or [cases]: they are, or are once more, long
# tests (label long, scripts/check.sh).
function(filasofia_tests name)
  cmake_parse_arguments(TEST "LONG" "TIMEOUT" "SOURCES;LINKS;PRECOMPILE" ${ARGN})
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 300)
  endif()
  add_executable(test_${name} ${TEST_SOURCES})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/tests
    ${PROJECT_BINARY_DIR}/generated)
  if(TARGET filasofia_${name})
    target_link_libraries(test_${name} PRIVATE filasofia_${name})
  endif()
  target_link_libraries(test_${name} PRIVATE ${TEST_LINKS} filasofia_flags filasofia_test_main)
  target_compile_definitions(test_${name} PRIVATE FILASOFIA_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    FILASOFIA_BINARY_DIR="${PROJECT_BINARY_DIR}")
  if(TEST_PRECOMPILE AND FILASOFIA_PRECOMPILE)
    target_precompile_headers(test_${name} PRIVATE ${FILASOFIA_TEST_HEADERS} ${TEST_PRECOMPILE})
  else()
    target_precompile_headers(test_${name} REUSE_FROM filasofia_test_main)
  endif()
  target_compile_options(test_${name} PRIVATE ${FILASOFIA_TEST_OPTIMISATION})
  if(FILASOFIA_FEWER_CASES)
    target_compile_definitions(test_${name} PRIVATE FILASOFIA_FEWER_CASES)
  endif()
  # Sources of tests share more headers than code: batches of 8 took a third longer to compile.
  set_target_properties(test_${name} PROPERTIES CXX_EXTENSIONS OFF UNITY_BUILD_BATCH_SIZE 16)
  catch_discover_tests(test_${name} TEST_SPEC ~[long] TEST_PREFIX "${name}: " EXTRA_ARGS -w NoTests
    PROPERTIES TIMEOUT ${TEST_TIMEOUT} LABELS ${name} SKIP_REGULAR_EXPRESSION "SKIPPED:") # tests/skip.h says it
  if(TEST_LONG)
    catch_discover_tests(test_${name} TEST_SPEC [long],[cases] TEST_PREFIX "long: ${name}: " EXTRA_ARGS -w NoTests
      PROPERTIES TIMEOUT 1200 LABELS long ENVIRONMENT FILASOFIA_ALL_CASES=1)
  endif()
endfunction()
