#!/usr/bin/env bash
# Builds a wheel that needs no library of Debian: those that e2lf reads files with are compiled from Debian's sources and linked
# in. It serves the Python that builds it, on distributions whose glibc is not older than the symbols that the module uses.
#   python/build_portable_wheel.sh FOLDER        writes FOLDER/e2lf-*.whl; needs Debian 12 with what `./run demo` and
#                                                docs/python.md install, dpkg-dev and nasm
set -euo pipefail
folder=$(realpath -m "${1:?names the folder for the wheel}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work=$PWD/build/portable
tree=$PWD/build/portable_wheel  # beside other build trees, whose compiled objects ccache then finds
prefix=$work/prefix

# unpack_source <package>: the source of a Debian package, from where this machine takes its packages.
unpack_source() {
  local apt=(-o "Dir::Etc::SourceList=$work/sources.list" -o Dir::Etc::SourceParts=/dev/null -o "Dir::State::Lists=$work/lists"
    -o APT::Sandbox::User=root)
  mkdir -p "$work/lists/partial" "$work/sources"
  if [ ! -e "$work/sources.list" ]; then
    apt-get indextargets --format '$(REPO_URI) $(CODENAME)' "Created-By: Packages" | grep ' bookworm$' |
      sed 's|.*|deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] & main|' >"$work/sources.list"
    apt-get "${apt[@]}" update -qq
  fi
  (cd "$work/sources" && rm -rf "$1"-* && apt-get "${apt[@]}" source -qq "$1" >/dev/null)
}

# build_library <package> <folder of its CMakeLists.txt> [CMake option...]: a static library that a module of Python can contain.
build_library() {
  local package=$1 build=$work/libraries/$1 source
  [ ! -e "$build/installed" ] || return 0
  unpack_source "$package"
  source=$(echo "$work/sources/$package"-*/)
  mkdir -p "$build"
  # In the folder of the build, where HDF5 expects what its tests of the compiler write.
  cd "$build"
  cmake -S "$source$2" -B . -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_INSTALL_LIBDIR:PATH=lib \
    -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF "${@:3}" >/dev/null
  cmake --build . --target install >/dev/null
  cp "$source/debian/copyright" "$work/licences/$package"
  touch installed
  cd "$OLDPWD"
}

mkdir -p "$work/licences"
for package in zlib1g-dev liblz4-dev libsqlite3-dev; do cp "/usr/share/doc/$package/copyright" "$work/licences/$package"; done

build_library highway . -DHWY_ENABLE_CONTRIB=OFF -DHWY_ENABLE_EXAMPLES=OFF
build_library libzstd build/cmake -DZSTD_BUILD_SHARED=OFF -DZSTD_BUILD_PROGRAMS=OFF
build_library libpng1.6 . -DPNG_SHARED=OFF -DPNG_TESTS=OFF
# Vector instructions are required, because without an assembler libjpeg-turbo would leave them out with only a warning.
build_library libjpeg-turbo . -DREQUIRE_SIMD=ON -DENABLE_SHARED=OFF -DWITH_TURBOJPEG=OFF
# Without SZIP and remote files (curl, OpenSSL), which no format of e2lf needs.
build_library hdf5 . -DHDF5_BUILD_TOOLS=OFF -DHDF5_BUILD_EXAMPLES=OFF -DHDF5_BUILD_HL_LIB=OFF -DHDF5_BUILD_CPP_LIB=OFF \
  -DHDF5_ENABLE_Z_LIB_SUPPORT=ON -DHDF5_ENABLE_SZIP_SUPPORT=OFF

PKG_CONFIG_PATH=$prefix/lib/pkgconfig cmake --preset release -B "$tree" -DCMAKE_PREFIX_PATH="$prefix" -DE2LF_STATIC_LIBRARIES=ON \
  -DE2LF_WITH_TORCH=OFF -DE2LF_WITH_ONEDNN=OFF -DE2LF_WITH_METAVISION=OFF -DE2LF_WITH_VIEWER=OFF -DE2LF_WITH_FILMS=OFF -DE2LF_WITH_DISPLAY=OFF \
  -DE2LF_WITH_PYTHON=ON
cmake --build "$tree" -j "$(nproc)" --target e2lf_python

module=$(echo "$tree"/python/e2lf/_e2lf*.so)
needed=$(objdump -p "$module" | sed -n 's/^ *NEEDED *//p' | sort)
echo "the module links:" $needed
others=$(grep -vE '^(libc|libm|libstdc\+\+|libgcc_s|ld-linux-x86-64|ld-linux-aarch64)\.so' <<<"$needed" || true)
[ -z "$others" ] || { echo "build_portable_wheel.sh: the module links libraries that other distributions may lack:" $others >&2; exit 1; }
glibc=$(objdump -T "$module" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
# What packs the wheel is called as pip calls it, which Debian's python3 alone does not have.
python=$(sed -n 's/^_\?Python_EXECUTABLE:[^=]*=//p' "$tree/CMakeCache.txt" | head -n 1)
mkdir -p "$folder"
PYTHONPATH=python "$python" - "$folder" "$tree" "$work/licences" "manylinux_${glibc#GLIBC_}_$(uname -m)" <<'PY'
import sys
import build_wheel
folder, tree, licences, platform = sys.argv[1:]
print(build_wheel.build_wheel(folder, {"build-dir": tree, "licences": licences, "platform": platform}))
PY
