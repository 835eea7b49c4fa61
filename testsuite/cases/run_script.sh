# ./run takes paths from the folder it is called in. The script itself runs, with a program that is built already: what would
# install and build is stood in for.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
mkdir -p repository/build/minimal/bin repository/build/release/bin tools caller
cp "$TESTSUITE/../run" repository/run
for preset in minimal release; do ln -s "$E2LF" "repository/build/$preset/bin/e2lf"; done
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
