# Finds the libraries of the programs and of the Python package, and determines their optional parts.
# Debian's FFmpeg is licensed under the GPL; see docs/packages.md.
pkg_check_modules(FFMPEG QUIET IMPORTED_TARGET libavformat libavcodec libswscale libavutil)
e2lf_optional(films FFMPEG_FOUND "films of e2lf animate"
  "libavformat-dev, libavcodec-dev, libswscale-dev and libavutil-dev" ": GIF, WebM, MP4")
pkg_check_modules(SDL2 QUIET IMPORTED_TARGET sdl2)
e2lf_optional(display SDL2_FOUND "e2lf codes play" "libsdl2-dev")
if(NOT DEFINED E2LF_WITH_TORCH OR E2LF_WITH_TORCH)
  find_package(Torch QUIET)
endif()
e2lf_optional(torch Torch_FOUND "training and torch in benchmarks" "libtorch-dev" ", ${Torch_VERSION}")
if(NOT DEFINED E2LF_WITH_ONEDNN OR E2LF_WITH_ONEDNN)
  find_package(dnnl 2.6 QUIET)
endif()
e2lf_optional(onednn dnnl_FOUND "oneDNN in benchmarks" "libdnnl-dev")

# The page of the viewer is built with npm packages, which ./run fetches into viewer/node_modules.
find_program(E2LF_NPM npm)
pkg_check_modules(HTTPLIB QUIET IMPORTED_TARGET cpp-httplib)
set(viewer_found FALSE)
if(E2LF_NPM AND HTTPLIB_FOUND AND EXISTS ${PROJECT_SOURCE_DIR}/viewer/node_modules/vite)
  set(viewer_found TRUE)
endif()
e2lf_optional(viewer viewer_found "e2lf view" "npm, libcpp-httplib-dev or the packages that `npm install` fetches in viewer/")

# The system's python3, unless Python_EXECUTABLE is set.
if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
if(E2LF_SANITIZE)
  set(E2LF_WITH_PYTHON OFF)  # python3 does not load modules with sanitizers
endif()
set(python_found FALSE)
if(NOT DEFINED E2LF_WITH_PYTHON OR E2LF_WITH_PYTHON)
  find_package(Python COMPONENTS Interpreter Development.Module NumPy QUIET)
  set(PYBIND11_FINDPYTHON ON)
  if(Python_FOUND)
    find_package(pybind11 QUIET)
    set(python_found ${pybind11_FOUND})
  endif()
endif()
e2lf_optional(python python_found "import e2lf"
  "python3-dev, python3-numpy and pybind11-dev for ${Python_EXECUTABLE}" ", Python ${Python_VERSION}")
