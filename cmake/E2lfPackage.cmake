# Debian packages: `cpack -G DEB` in the build folder makes e2lf (programs, models, manual), e2lf-dev (headers, libraries)
# and python3-e2lf, each with the packages that its files need. Configure with CMAKE_INSTALL_PREFIX=/usr: Debian's folder of
# libraries follows from that.
set(CPACK_PACKAGE_NAME e2lf)
set(CPACK_PACKAGE_VENDOR "the e2lf authors")
set(CPACK_PACKAGE_CONTACT "the e2lf authors")  # who publishes packages states an address: cpack -D CPACK_PACKAGE_CONTACT=...
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "light fields from the events of a coded-aperture camera")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR DEB)

set(CPACK_COMPONENTS_ALL program development)
if(BUILD_SHARED_LIBS)
  list(APPEND CPACK_COMPONENTS_ALL library)
endif()
if(TARGET e2lf_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(TARGET e2lf-train)
  list(APPEND CPACK_COMPONENTS_ALL training)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_SECTION science)

# The packages of one build require each other in the same version.
set(same_version "e2lf (= ${PROJECT_VERSION})")
set(development_libraries libhdf5-dev nlohmann-json3-dev)
if(BUILD_SHARED_LIBS)
  set(libraries "libe2lf${E2LF_SOVERSION} (= ${PROJECT_VERSION})")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libe2lf${E2LF_SOVERSION})
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
  set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "Shared libraries of e2lf, which its programs and other programs load.")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS ${libraries})
  set(same_version "${same_version}, ${libraries}")
else()
  # Programs that link static libraries link also what these use.
  list(APPEND development_libraries libhwy-dev libpng-dev libjpeg62-turbo-dev zlib1g-dev liblz4-dev libzstd-dev libsqlite3-dev)
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME e2lf)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION
"e2lf reconstructs a 4-D light field from the events of one event camera
behind a display in the aperture of its lens. It reads recordings of event
cameras, simulates them, reconstructs, measures and shows the results.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME e2lf-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
list(JOIN development_libraries ", " development_libraries)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${same_version}, ${development_libraries}")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"Libraries to link with, headers, and the files by which CMake and
pkg-config find them.
Each module is a library of its own: recordings, light fields, simulation,
reconstruction.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-e2lf)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION
"The functions of e2lf for Python, with numpy arrays: recordings, event
images, simulation, reconstruction, light fields, measures.")
set(CPACK_DEBIAN_TRAINING_PACKAGE_NAME e2lf-train)
set(CPACK_DEBIAN_TRAINING_PACKAGE_DEPENDS "${same_version}")
set(CPACK_DEBIAN_TRAINING_DESCRIPTION
"Learns aperture patterns and the network that reconstructs light fields from
the events they make, and reconstructs on a GPU, on libtorch.")

# Adds the files that Debian requires in each package; see the script.
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
set(CPACK_E2LF_SOURCE_DIR ${PROJECT_SOURCE_DIR})
if(TARGET e2lf_python)
  string(REPLACE "." ";" python_version ${Python_VERSION})
  list(GET python_version 0 major)
  list(GET python_version 1 minor)
  math(EXPR next "${minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "${same_version}, python3 (>= ${major}.${minor}), python3 (<< ${major}.${next}), python3-numpy")
endif()
include(CPack)
