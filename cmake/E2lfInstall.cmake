# Installs programs, models and cameras, and each public module as a component of the package e2lf for CMake
# (find_package(e2lf COMPONENTS recon)) and pkg-config (e2lf-recon).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(E2LF_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/e2lf)

# The binary interface changes with each minor version before 1.0, and with each major version from 1.0 on. It determines the
# name of shared libraries and the versions that find_package() accepts.
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(E2LF_SOVERSION 0.${PROJECT_VERSION_MINOR})
  set(E2LF_COMPATIBILITY SameMinorVersion)
else()
  set(E2LF_SOVERSION ${PROJECT_VERSION_MAJOR})
  set(E2LF_COMPATIBILITY SameMajorVersion)
endif()

if(BUILD_SHARED_LIBS)
  # Programs and libraries find each other under any prefix.
  list(APPEND CMAKE_INSTALL_RPATH "\$ORIGIN" "\$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
endif()

# The external libraries of modules: target, CMake package, and name in pkg-config.
set(E2LF_EXTERNAL_TARGETS
  "PkgConfig::HWY" "PkgConfig::HDF5" "PkgConfig::LZ4" "PkgConfig::ZSTD" "PkgConfig::SQLITE" "ZLIB::ZLIB" "PNG::PNG" "JPEG::JPEG"
  "nlohmann_json::nlohmann_json" "OpenMP::OpenMP_CXX" "Threads::Threads" "Metavision::HAL_discovery")
set(E2LF_EXTERNAL_FINDS
  "pkg:HWY" "pkg:HDF5" "pkg:LZ4" "pkg:ZSTD" "pkg:SQLITE" "ZLIB" "PNG" "JPEG" "nlohmann_json" "OpenMP" "Threads" "MetavisionHAL")
set(E2LF_EXTERNAL_PKGS "libhwy" "hdf5" "liblz4" "libzstd" "sqlite3" "zlib" "libpng" "libjpeg" "nlohmann_json" "-fopenmp" "-pthread" "metavision")

# e2lf_offer_module(<module> <header...>): e2lf_install_package() installs it. Headers are named from the module's folder.
function(e2lf_offer_module module)
  set_target_properties(e2lf_${module} PROPERTIES E2LF_HEADERS "${ARGN}")
  set_property(GLOBAL APPEND PROPERTY E2LF_COMPONENT_NAMES ${module})
endfunction()

# Installs one module and records its dependencies. All targets that it links must exist.
function(e2lf_install_module module)
  set(target e2lf_${module})
  get_target_property(headers ${target} E2LF_HEADERS)
  get_target_property(folder ${target} SOURCE_DIR)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${module} VERSION ${PROJECT_VERSION} SOVERSION ${E2LF_SOVERSION})
  target_include_directories(${target} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS ${target} EXPORT e2lf-${module} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
  install(EXPORT e2lf-${module} NAMESPACE e2lf:: FILE e2lf-${module}-targets.cmake DESTINATION ${E2LF_CMAKE_DIR}
    COMPONENT development)
  foreach(header IN LISTS headers)
    get_filename_component(inner_folder ${header} DIRECTORY)
    install(FILES ${folder}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/e2lf/${module}/${inner_folder} COMPONENT development)
  endforeach()

  set(modules) # of ours that this one needs
  set(finds)
  set(pkg_requires)
  set(pkg_flags)
  get_target_property(public ${target} INTERFACE_LINK_LIBRARIES)
  get_target_property(all ${target} LINK_LIBRARIES)
  get_target_property(kind ${target} TYPE)
  foreach(library IN LISTS public all)
    list(FIND E2LF_EXTERNAL_TARGETS "${library}" place)
    if(kind STREQUAL "SHARED_LIBRARY" AND NOT library IN_LIST public AND NOT library STREQUAL "Metavision::HAL_discovery")
      set(place -1)  # it is linked already; CMake asks for other shared libraries that are targets
    endif()
    if(library MATCHES "^e2lf::(.*)")
      list(APPEND modules ${CMAKE_MATCH_1})
      list(APPEND pkg_requires "e2lf-${CMAKE_MATCH_1}")
    elseif(place GREATER_EQUAL 0)
      list(GET E2LF_EXTERNAL_FINDS ${place} find)
      list(GET E2LF_EXTERNAL_PKGS ${place} pkg)
      list(APPEND finds ${find})
      if(pkg STREQUAL "metavision")  # which has no .pc file
        list(APPEND pkg_flags ${E2LF_METAVISION_FLAGS})
      elseif(pkg MATCHES "^-")
        list(APPEND pkg_flags ${pkg})
      else()
        list(APPEND pkg_requires ${pkg})
      endif()
    endif()
  endforeach()
  list(REMOVE_DUPLICATES modules)
  list(REMOVE_DUPLICATES finds)
  list(REMOVE_DUPLICATES pkg_requires)
  list(REMOVE_DUPLICATES pkg_flags)
  set_property(GLOBAL APPEND_STRING PROPERTY E2LF_COMPONENTS
    "set(e2lf_${module}_modules ${modules})\nset(e2lf_${module}_finds ${finds})\n")

  # From the .pc file, so that the package works under any prefix.
  file(RELATIVE_PATH to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" to_prefix "${to_prefix}")  # the compiler takes // in a macro for a comment
  list(JOIN pkg_requires " " pkg_requires)
  list(JOIN pkg_flags " " pkg_flags)
  set(pkg_cflags)
  if(module STREQUAL "files" AND NOT BUILD_SHARED_LIBS)
    set(pkg_cflags "-DE2LF_DATA_FOLDER=\${prefix}/${CMAKE_INSTALL_DATADIR}/e2lf")
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/e2lf-module.pc.in ${PROJECT_BINARY_DIR}/generated/e2lf-${module}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/generated/e2lf-${module}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT development)
endfunction()

# e2lf_install_package(): installs the public modules and the other files of the package. It must be called last.
function(e2lf_install_package)
  get_property(E2LF_COMPONENT_NAMES GLOBAL PROPERTY E2LF_COMPONENT_NAMES)
  foreach(module IN LISTS E2LF_COMPONENT_NAMES)
    e2lf_install_module(${module})
  endforeach()
  get_property(E2LF_COMPONENTS GLOBAL PROPERTY E2LF_COMPONENTS)
  set(E2LF_PKG_NAMES "set(e2lf_pkg_HWY libhwy)\nset(e2lf_pkg_HDF5 hdf5)\nset(e2lf_pkg_LZ4 liblz4)\nset(e2lf_pkg_ZSTD libzstd)\nset(e2lf_pkg_SQLITE sqlite3)")
  set(E2LF_DATA_DIR ${CMAKE_INSTALL_DATADIR}/e2lf)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/e2lfConfig.cmake.in ${PROJECT_BINARY_DIR}/generated/e2lfConfig.cmake
    INSTALL_DESTINATION ${E2LF_CMAKE_DIR} PATH_VARS E2LF_DATA_DIR)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/e2lfConfigVersion.cmake COMPATIBILITY ${E2LF_COMPATIBILITY})
  install(FILES ${PROJECT_BINARY_DIR}/generated/e2lfConfig.cmake ${PROJECT_BINARY_DIR}/generated/e2lfConfigVersion.cmake
    DESTINATION ${E2LF_CMAKE_DIR} COMPONENT development)

  install(DIRECTORY ${PROJECT_SOURCE_DIR}/models ${PROJECT_SOURCE_DIR}/cameras ${PROJECT_SOURCE_DIR}/configs
    DESTINATION ${CMAKE_INSTALL_DATADIR}/e2lf COMPONENT program)
  install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  if(TARGET e2lf-train)
    install(TARGETS e2lf-train e2lf-torch RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT training)
  endif()
  if(TARGET e2lf)
    install(TARGETS e2lf RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
    install(FILES ${PROJECT_SOURCE_DIR}/src/e2lf/cli/completion.bash RENAME e2lf
      DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
    find_program(E2LF_HELP2MAN help2man)
    if(E2LF_HELP2MAN)
      install(CODE "execute_process(COMMAND ${PROJECT_SOURCE_DIR}/scripts/make_manual.sh $<TARGET_FILE:e2lf>
        \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)
    endif()
  endif()
  if(PROJECT_IS_TOP_LEVEL)
    include(E2lfPackage)
  endif()
endfunction()
