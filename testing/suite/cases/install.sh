# The installed package, and e2lf as a part of another project.

part install
# The installed package, from an empty folder: the program finds its models, the examples build with CMake and with pkg-config
# and run, and the headers need no others.
skip_sanitizers "the package of a build with sanitizers links with them alone"
[ -n "${E2LF_BUILD:-}" ] || skip "E2LF_BUILD does not name the build folder"
cmake --install "$E2LF_BUILD" --prefix "$PWD/first" >install.log || fail "$(tail -5 install.log)"
# Moved twice: programs that link the static libraries find the models all the same.
mv first second
mv second prefix
installed=$PWD/prefix/bin/e2lf
# No file contains a path of the build, apart from debugging information and the simulated camera of the tests.
find prefix -name '*.a' -exec strip --strip-debug {} +
strip prefix/bin/* $(find prefix -name '_e2lf*.so')
sources=$(realpath "$SOURCES")
grep -raoh "$sources[[:print:]]*" prefix | grep -v stand_in_hal >paths.txt || true
[ ! -s paths.txt ] || fail "paths of the build are installed: $(sort -u paths.txt | head -5)"
in_clean_root "$installed" demo -o demo --width 96 --height 64 --quiet
exists demo/scene prefix/share/e2lf/models/e2lf-n4.safetensors
# The library of a camera lies in a prefix of its own: the program finds it there, and so does what is built with the package.
if "$installed" --version | grep "^metavision: ON (.*simulated" >/dev/null; then
  [ "$(E2LF_STAND_IN=serial=A1 "$installed" camera list --quiet)" = camera://metavision/e2lf:stand_in:A1 ] || fail "the HAL"
fi

cmake -S "$SOURCES/examples" -B examples -G Ninja -DCMAKE_PREFIX_PATH="$PWD/prefix" -DCMAKE_BUILD_TYPE=Release >configure.log 2>&1 ||
  fail "$(tail -20 configure.log)"
cmake --build examples >build.log 2>&1 || fail "$(grep -m 5 -A 3 'error' build.log)"

model=prefix/share/e2lf/models/e2lf-n4.safetensors
"$installed" simulate demo/scene -m "$model" -o events.npz --quiet
in_clean_root examples/events_to_light_field "$model" events.npz fields
exists fields/07_07.png
"$installed" reconstruct events.npz -m "$model" -o own --precision auto --quiet
for view in 00_00 07_07; do cmp "fields/$view.png" "own/$view.png" || fail "the example gave another light field"; done

# Records of 12 bytes, see the example; two of five events lie outside of its sensor.
py -c "
import struct, sys
for t, x, y, p in ((5, 1, 2, 1), (6, 639, 479, 0), (7, 640, 0, 1), (8, 3, 480, 1), (9, 4, 4, 0)):
    sys.stdout.buffer.write(struct.pack('<qHH', t, x, y | p << 15))" >records.bin
examples/custom_codec records.bin records.raw >codec.txt 2>codec.err || fail "$(cat codec.err)"
grep -qx "3 events" codec.txt || fail "$(cat codec.txt)"
"$installed" convert records.raw records.csv --quiet
grep -v % records.csv | sort | tr '\n' ' ' | grep -q "1,2,1,5 4,4,0,9 639,479,0,6" || fail "$(cat records.csv)"

"$installed" simulate demo/scene -m "$model" -o recording.raw --cycles 3 --quiet
examples/custom_camera recording.raw | tail -1 | grep -qx "3 cycles" || fail "the camera of the example"
examples/custom_sensor_model >psnr.txt
py -c "
lines = [float(line.split()[-2]) for line in open('psnr.txt')]
assert len(lines) == 2 and lines[0] > lines[1] > 5, lines" || fail "$(cat psnr.txt)"
examples/thread_pool "$model" events.npz 3 | sort -u | wc -l | grep -qx 1 || fail "threads gave different light fields"

# pkg-config, for one program.
PKG_CONFIG_PATH=$(dirname "$(find "$PWD/prefix" -name e2lf-base.pc)")
export PKG_CONFIG_PATH
c++ -O1 "$SOURCES/examples/custom_codec.cpp" -o with_pkg_config $(pkg-config --cflags --libs e2lf-recordings) ||
  fail "pkg-config"
rm records.raw
LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH") ./with_pkg_config records.bin records.raw 2>/dev/null | grep -qx "3 events" || fail "the program made with pkg-config"

# A program without models says that, and not that no model was trained for the patterns.
mkdir -p alone/bin
cp prefix/bin/e2lf alone/bin
fails 1 "E2LF_MODELS" alone/bin/e2lf reconstruct events.npz -o lost
E2LF_MODELS=$PWD/prefix/share/e2lf/models alone/bin/e2lf reconstruct events.npz -o found --quiet

# Python: from the prefix alone, in an empty folder; the files that come with e2lf are the installed ones.
if [ -d "$E2LF_BUILD/python/e2lf" ]; then
  mkdir python
  (cd python && PYTHONPATH=$(dirname "$(find ../prefix -type d -path '*-packages/e2lf')") in_clean_root /usr/bin/python3 -c '
import e2lf, os
prefix = os.path.realpath("../prefix")
assert os.path.realpath(e2lf.__file__).startswith(prefix) and e2lf.bundled_model().startswith(prefix), e2lf.__file__
model = e2lf.read_model(e2lf.bundled_model())
assert e2lf.Reconstructor(model).reconstruct(e2lf.read_event_images("../events.npz").cycles[0]).shape[:2] == (8, 8)
assert e2lf.read_camera("ideal").name
') || fail "import e2lf"
fi

# Headers: none needs one that stays out. What a component does not have is said.
for header in $(cd prefix/include && find e2lf -name '*.h'); do echo "#include <$header>"; done >all.txt
c++ -fsyntax-only -x c++ $(pkg-config --cflags e2lf-recon e2lf-eval e2lf-cycles) all.txt || fail "a header needs one that is not installed"
mkdir wrong
printf 'cmake_minimum_required(VERSION 3.22)\nproject(x CXX)\nfind_package(e2lf REQUIRED COMPONENTS reconn)\n' >wrong/CMakeLists.txt
if cmake -S wrong -B wrong/build -DCMAKE_PREFIX_PATH="$PWD/prefix" >wrong.txt 2>&1; then fail "a component that is not there"; fi
grep -q "no component reconn" wrong.txt || fail "$(cat wrong.txt)"

# Shared libraries have a name of their own for each version that breaks what is linked with them: every minor one before 1.0.
cmake -S "$SOURCES" -B shared -G Ninja -DBUILD_SHARED_LIBS=ON -DE2LF_BUILD_TESTS=OFF -DE2LF_WITH_TORCH=OFF \
  -DE2LF_WITH_VIEWER=OFF -DE2LF_WITH_PYTHON=OFF >configure.log 2>&1 || fail "$(tail -20 configure.log)"
grep -q "SONAME = libe2lf_base.so.0.1$" shared/build.ninja || fail "$(grep -m 1 'SONAME = libe2lf_base' shared/build.ninja)"
# What links them needs the packages of their headers alone.
grep "^set(e2lf_recordings_finds" shared/generated/e2lfConfig.cmake | grep -q LZ4 && fail "a shared library needs its private packages"
! grep -q liblz4 shared/generated/e2lf-recordings.pc || fail "so does pkg-config"

# The lines of docs/library.md, for a program that reconstructs with a bundled model; it lies outside of the prefix. The path
# contains a macro of GNU dialects.
page=$SOURCES/docs/library.md
mkdir -p linux/mine
mv prefix linux/prefix
cp "$TESTSUITE/parent/main.cpp" linux/mine/mine.cpp
cd linux/mine
{
  printf 'cmake_minimum_required(VERSION 3.24)\nproject(mine CXX)\nadd_executable(mine mine.cpp)\n'
  py "$TESTSUITE/documents/documents.py" block "$page" find_package
} >CMakeLists.txt
cmake -S . -B build -DCMAKE_PREFIX_PATH="$case_folder/install/linux/prefix" >configure.log 2>&1 || fail "$(tail -5 configure.log)"
cmake --build build >build.log 2>&1 || fail "$(grep -m 5 -A 3 error build.log)"
PKG_CONFIG_PATH=$(dirname "$(find "$case_folder/install/linux/prefix" -name e2lf-base.pc)")
export PKG_CONFIG_PATH
py "$TESTSUITE/documents/documents.py" block "$page" pkg-config >compile.sh
sed '/^c++/s/$/ -std=gnu++20/' compile.sh >compile_gnu.sh
for script in compile.sh compile_gnu.sh; do
  sh -e "$script" || fail "pkg-config"
  for program in build/mine ./mine; do
    found=$(LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH") in_clean_root "$program") || fail "$program: $found"
    [ "$(realpath "$found")" = "$case_folder/install/linux/prefix/share/e2lf/models/e2lf-n4-geometry.safetensors" ] || fail "$program: $found"
  done
done

part subproject
# A project that contains e2lf builds only the library that it links, finds its models, and keeps its settings and packages.
skip_sanitizers "the compiler of a build with sanitizers is not the subject"
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
# e2lf::recon needs no picture library, HDF5 or LZ4: they are hidden here, and what needs them is left out.
mkdir hidden
for name in libhwy zlib; do cp "$(find /usr/lib /usr/share /usr/local -name $name.pc 2>/dev/null | head -1)" hidden/; done
PKG_CONFIG_LIBDIR=$PWD/hidden cmake -S "$TESTSUITE/parent" -B parent -G Ninja -DCMAKE_INSTALL_PREFIX="$PWD/prefix" -DCMAKE_CXX_FLAGS=-O0 \
  -DCMAKE_DISABLE_FIND_PACKAGE_PNG=ON -DCMAKE_DISABLE_FIND_PACKAGE_JPEG=ON -DCMAKE_DISABLE_FIND_PACKAGE_OpenSSL=ON >configure.log 2>&1 ||
  fail "$(grep -A 5 Error configure.log)"
grep -q "libpng-dev not found: no lightfield" configure.log || fail "$(cat configure.log)"
grep -q "liblz4-dev not found: no recordings" configure.log || fail "$(cat configure.log)"
if ninja -C parent -t commands | grep src/e2lf/engine | grep -q -- ' -O3'; then fail "the project asked for -O0"; fi
commands=$(ninja -C parent -t commands | grep -c -- ' -c ')
[ "$commands" -le 35 ] || fail "e2lf::recon needs $commands sources"
ctest --test-dir parent -N | grep -q "Total Tests: 0" || fail "tests of e2lf"
cmake --build parent >build.log 2>&1 || fail "$(grep -m 5 -A 3 error build.log)"
[ "$(parent/parent)" = "$(realpath "$SOURCES/models/e2lf-n4-geometry.safetensors")" ] || fail "the program found $(parent/parent)"
cmake --install parent >install.log || fail "$(tail -5 install.log)"
[ "$(cd prefix && find . -type f)" = ./bin/parent ] || fail "installed: $(find prefix -type f)"
grep -q 'CPACK_PACKAGE_NAME "parent"' parent/CPackConfig.cmake || fail "the package is that of e2lf"

# With E2LF_INSTALL, the libraries, models and cameras are installed beside the program, which finds them there.
cmake parent -DE2LF_INSTALL=ON >configure.log 2>&1 || fail "$(grep -A 5 Error configure.log)"
cmake --install parent --component program >install.log || fail "$(tail -5 install.log)"
found=$(in_clean_root prefix/bin/parent)
[ "$found" = "$PWD/prefix/share/e2lf/models/e2lf-n4-geometry.safetensors" ] || fail "the installed program found $found"

# Without any statement on the optimisation, e2lf is optimised, and the project is left as it is.
CXXFLAGS='' cmake -S "$TESTSUITE/parent" -B unstated -G Ninja >configure.log 2>&1 || fail "$(grep -A 5 Error configure.log)"
ninja -C unstated -t commands parent >commands.txt
grep -- ' -c .*src/e2lf/engine' commands.txt | grep -qv -- ' -O3' && fail "a kernel without -O3: $(grep -m 1 src/e2lf/engine commands.txt)"
if grep -- ' -c .*parent/main.cpp' commands.txt | grep -q -- ' -O3'; then fail "the project is compiled with -O3"; fi

part fetched
# The lines of docs/library.md for FetchContent, with a clone of these sources as the repository.
git -C "$SOURCES" rev-parse HEAD >/dev/null 2>&1 || skip "the sources are no clone"
git clone --quiet --bare --depth 1 "file://$(git -C "$SOURCES" rev-parse --show-toplevel)" clone.git
git -C clone.git update-ref refs/heads/main HEAD
{
  printf 'cmake_minimum_required(VERSION 3.24)\nproject(mine CXX)\nadd_executable(mine mine.cpp)\n'
  py "$TESTSUITE/documents/documents.py" block "$SOURCES/docs/library.md" FetchContent
} >CMakeLists.txt
cp "$TESTSUITE/parent/main.cpp" mine.cpp
cmake -S . -B build -G Ninja -DE2LF_REPOSITORY="file://$PWD/clone.git" >configure.log 2>&1 || fail "$(tail -20 configure.log)"
ninja -C build -n mine >commands.txt || fail "$(tail -5 commands.txt)"
[ "$(git -C build/_deps/e2lf-src rev-list --count HEAD)" = 1 ] || fail "the whole history was fetched"

part plain_build
# `cmake -S . -B build` without the packages of the tests builds the rest, and says what they are; other packages are named as
# Debian names them, all at once.
configure() { cmake -S "$SOURCES" -B "$1" -G Ninja -DE2LF_WITH_TORCH=OFF -DE2LF_WITH_PYTHON=OFF -DE2LF_WITH_VIEWER=OFF "${@:2}" >"$1.txt" 2>&1; }
configure tests -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON || fail "$(tail -5 tests.txt)"
[ "$(grep -c "libgtest-dev" tests.txt)" = 1 ] || fail "$(tail -20 tests.txt)"
grep -qx -- "--   tests: OFF (apt-get install libgtest-dev libgmock-dev)" tests.txt || fail "$(tail -20 tests.txt)"
if configure asked -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON -DE2LF_BUILD_TESTS=ON; then fail "tests without GoogleTest"; fi
grep -q "packages of Debian: libgtest-dev" asked.txt || fail "$(tail -5 asked.txt)"
if configure library -DCMAKE_DISABLE_FIND_PACKAGE_PNG=ON -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON; then fail "without libpng"; fi
grep -q "apt-get install libpng-dev libeigen3-dev$" library.txt || fail "$(tail -5 library.txt)"
