# The functions that the CMakeLists.txt of every module calls. Each folder is one target and one namespace.

# Warnings, sanitizers and debug checks, only for the sources of e2lf.
add_library(e2lf_flags INTERFACE)
target_compile_options(e2lf_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 wrongly reports overlaps when strings are concatenated (GCC bug 105651).
  target_compile_options(e2lf_flags INTERFACE -Wno-restrict)
endif()
if(E2LF_WARNINGS_AS_ERRORS)
  target_compile_options(e2lf_flags INTERFACE -Werror)
endif()
if(E2LF_ASSERTIONS)
  target_compile_definitions(e2lf_flags INTERFACE E2LF_ASSERTIONS _GLIBCXX_ASSERTIONS)
endif()
if(E2LF_SANITIZE)
  target_compile_options(e2lf_flags INTERFACE -fsanitize=${E2LF_SANITIZE} -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(e2lf_flags INTERFACE -fsanitize=${E2LF_SANITIZE})
endif()

# Precompiled headers of external libraries, for full builds. Builds without them find missing includes.
# e2lf_add_precompiled(<name> <LIBRARY|PROGRAM> <libraries> <header...>) declares one that targets share by its name. GCC
# accepts it only for targets with the same setting of OpenMP (one of the libraries) and the same kind of code placement.
function(e2lf_add_precompiled name kind libraries)
  if(NOT E2LF_PRECOMPILE)
    return()
  endif()
  file(WRITE ${PROJECT_BINARY_DIR}/generated/${name}.cpp "")
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/generated/${name}.cpp)
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:e2lf_flags> ${libraries})
  target_precompile_headers(${name} PRIVATE ${ARGN})
  if(kind STREQUAL "PROGRAM")
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${name} PRIVATE -fPIE)
  endif()
endfunction()

# e2lf_use_precompiled(<target> <name>): uses the precompiled headers of this name if they exist.
function(e2lf_use_precompiled target name)
  if(TARGET "${name}")
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()

# e2lf_compile_together(<target>): compiles several sources together, so that their headers are read once. Kernels are
# excluded, because Highway compiles their sources several times. The groups have CMake's default size, eight, in every build,
# and sources that depend on a feature come last, so that names of unnamed namespaces that collide do so in the build of the tests.
function(e2lf_compile_together target)
  if(NOT E2LF_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(source MATCHES "\\.cpp$" AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source})
      file(STRINGS ${CMAKE_CURRENT_SOURCE_DIR}/${source} kernels REGEX "foreach_target.h" LIMIT_COUNT 1)
      if(kernels)
        set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      endif()
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
  # GCC treats the included sources as headers, in which a class must not contain a type of an unnamed namespace.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# e2lf_compile_quickly(<target>): reduces the optimisation of code that formats, parses and declares, whose templates take
# long to optimise and which does not run often.
function(e2lf_compile_quickly target)
  target_compile_options(${target} PRIVATE -O1)
endfunction()

# e2lf_add_library(<module> SRCS ... [HEADERS ...] [PUBLIC_LINK_LIBS ...] [PRIVATE_LINK_LIBS ...]
#                  [PRIVATE_DEFINITIONS ...] [PRECOMPILED <name>])
# Defines e2lf_<module> with the alias e2lf::<module>. HEADERS are the public headers, with all headers that they include. A
# module with public headers is installed, and is a shared library if BUILD_SHARED_LIBS is on.
function(e2lf_add_library module)
  cmake_parse_arguments(ARG "" "PRECOMPILED" "SRCS;HEADERS;PUBLIC_LINK_LIBS;PRIVATE_LINK_LIBS;PRIVATE_DEFINITIONS" ${ARGN})
  set(kind STATIC)
  if(ARG_HEADERS AND BUILD_SHARED_LIBS)
    set(kind SHARED)
  endif()
  add_library(e2lf_${module} ${kind} ${ARG_SRCS})
  add_library(e2lf::${module} ALIAS e2lf_${module})
  target_include_directories(e2lf_${module} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  target_compile_features(e2lf_${module} PUBLIC cxx_std_20)
  target_link_libraries(e2lf_${module} PUBLIC ${ARG_PUBLIC_LINK_LIBS} PRIVATE $<BUILD_INTERFACE:e2lf_flags> ${ARG_PRIVATE_LINK_LIBS})
  target_compile_definitions(e2lf_${module} PRIVATE ${ARG_PRIVATE_DEFINITIONS})
  if(kind STREQUAL "SHARED")
    # Only the names of e2lf's namespace are visible.
    set(names ${PROJECT_SOURCE_DIR}/cmake/visible_names.map)
    target_link_options(e2lf_${module} PRIVATE -Wl,--version-script=${names} -Wl,--no-undefined)
    set_target_properties(e2lf_${module} PROPERTIES LINK_DEPENDS ${names} DEFINE_SYMBOL "")
  endif()
  e2lf_use_precompiled(e2lf_${module} "${ARG_PRECOMPILED}")
  e2lf_compile_together(e2lf_${module})
  if(ARG_HEADERS AND NOT E2LF_LEARN_ONLY AND NOT E2LF_FUZZ)
    e2lf_offer_module(${module} ${ARG_HEADERS})
  endif()
endfunction()

# e2lf_add_executable(<name> SRCS ... [LINK_LIBS ...])
function(e2lf_add_executable name)
  cmake_parse_arguments(ARG "" "" "SRCS;LINK_LIBS" ${ARGN})
  add_executable(${name} ${ARG_SRCS})
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:e2lf_flags> ${ARG_LINK_LIBS})
endfunction()

# The time limit of a test. The slowest one takes a tenth of it on two busy cores.
set(E2LF_TEST_LIMIT_S 3600)

# e2lf_add_test(<module> [WITH_TORCH] SRCS ... [LINK_LIBS ...] [LABELS ...]): one GoogleTest binary for a module; CTest names are module/Suite.case.
# Tests that read data find it with the environment variable E2LF_DATA (see CONTRIBUTING.md).
function(e2lf_add_test module)
  if(NOT E2LF_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "WITH_TORCH" "" "SRCS;LINK_LIBS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  set(name e2lf_${module}_test)
  add_executable(${name} ${ARG_SRCS})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})  # testing/
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:e2lf_flags> ${ARG_LINK_LIBS} GTest::gmock GTest::gtest_main)
  e2lf_compile_quickly(${name})
  e2lf_compile_together(${name})
  add_dependencies(e2lf_unit_tests ${name})
  if(NOT ARG_WITH_TORCH)  # torch's macros are not those that the headers were compiled with
    e2lf_use_precompiled(${name} e2lf_test_headers)
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${module}/" DISCOVERY_MODE PRE_TEST NO_PRETTY_VALUES
    DISCOVERY_TIMEOUT 300  # a cold start of libtorch takes longer than the usual 5 s
    PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${E2LF_TEST_LIMIT_S})
endfunction()

# e2lf_feature(<name> <ON|OFF> <reason>): adds a row to the table at the end of the configuration.
function(e2lf_feature name state reason)
  set_property(GLOBAL APPEND PROPERTY E2LF_FEATURES "${name}: ${state} (${reason})")
endfunction()

# Prints the table and writes it for `e2lf --version`.
function(e2lf_print_features)
  get_property(rows GLOBAL PROPERTY E2LF_FEATURES)
  message(STATUS "e2lf features:")
  set(E2LF_FEATURE_LINES)
  foreach(row IN LISTS rows)
    message(STATUS "  ${row}")
    string(REGEX REPLACE "[\"\\\\]" "" line "${row}")
    string(APPEND E2LF_FEATURE_LINES "    \"${line}\\n\"\n")
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/src/e2lf/cli/features.h.in ${PROJECT_BINARY_DIR}/generated/e2lf/cli/features.h @ONLY)
endfunction()
