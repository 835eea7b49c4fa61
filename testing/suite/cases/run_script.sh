# ./run takes paths from the folder it is called in. The script itself runs, with a program that is built already: what would
# install and build is stood in for.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
mkdir -p repository/build/release/bin tools caller
cp "$SOURCES/run" repository/run
ln -s "$E2LF" repository/build/release/bin/e2lf
printf '#!/bin/sh\necho "-- e2lf features:"\n' >tools/cmake
printf '#!/bin/sh\nprintf "install ok installed"\n' >tools/dpkg-query
chmod +x tools/*
export PATH=$PWD/tools:$PATH
find repository | sort >before.txt
"$E2LF" simulate demo/scene -o caller/rec.raw --quiet
cd caller
"$E2LF" info rec.raw --json >expected.json
../repository/run e2lf info rec.raw --json >info.json 2>log.txt
cmp expected.json info.json
../repository/run e2lf convert rec.raw out.csv --quiet >stdout.txt 2>log.txt
exists out.csv
../repository/run e2lf eval ../demo/scene ../demo/recon -o eval.json --quiet 2>log.txt
exists eval.json
../repository/run demo --width 48 --height 32 --quiet 2>log.txt >stdout.txt
exists out/demo/run.json
fails 1 "nowhere.raw" ../repository/run e2lf info nowhere.raw
fails 2 "see e2lf eval --help" ../repository/run e2lf eval
cd ..
find repository | sort >after.txt
cmp before.txt after.txt

# A clone that was moved, or copied with its build folder, builds on: the cache of the old place alone is made anew.
mkdir first
cp "$SOURCES/run" first/run
cat >first/CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.22)
project(moved NONE)
message(STATUS "e2lf features:")
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
add_custom_target(e2lf COMMAND ln -sf $ENV{E2LF} ${CMAKE_BINARY_DIR}/bin/e2lf)
CMAKE
cat >first/CMakePresets.json <<'JSON'
{"version": 3, "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build/release"}]}
JSON
rm tools/cmake
export E2LF
first/run e2lf --version >version.txt 2>log.txt || fail "$(cat log.txt)"
if grep -q "was made for" log.txt; then fail "a first build: $(cat log.txt)"; fi
echo mine >first/build/release/notes.txt
mv first second
cp -r second third
for clone in second third; do
  $clone/run e2lf --version >version.txt 2>log.txt || fail "$clone: $(cat log.txt)"
  grep -q "run: build/release was made for $PWD/first: configuring it again for $PWD/$clone" log.txt || fail "$(cat log.txt)"
  [ "$(cat $clone/build/release/notes.txt)" = mine ] || fail "a file in the build folder is gone"
  $clone/run e2lf --version >version.txt 2>log.txt
  if grep -q "was made for" log.txt; then fail "again: $(cat log.txt)"; fi
done
# Another way to the same place is no move.
ln -s second link
link/run e2lf --version >version.txt 2>log.txt || fail "$(cat log.txt)"
if grep -q "was made for" log.txt; then fail "a link: $(cat log.txt)"; fi
