# A project that contains e2lf builds only the library that it links, finds its models, and keeps its settings and packages.
skip_sanitizers "the compiler of a build with sanitizers is not the subject"
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
cmake -S "$TESTSUITE/parent" -B parent -G Ninja -DCMAKE_INSTALL_PREFIX="$PWD/prefix" -DCMAKE_CXX_FLAGS=-O0 >configure.log 2>&1 ||
  fail "$(grep -A 5 Error configure.log)"
commands=$(ninja -C parent -t commands | grep -c -- ' -c ')
[ "$commands" -le 30 ] || fail "e2lf::engine needs $commands sources"
ctest --test-dir parent -N | grep -q "Total Tests: 0" || fail "tests of e2lf"
cmake --build parent >build.log 2>&1 || fail "$(grep -m 5 -A 3 error build.log)"
[ "$(parent/parent)" = "$(realpath "$TESTSUITE/../models/e2lf-n4.safetensors")" ] || fail "the program found $(parent/parent)"
cmake --install parent >install.log || fail "$(tail -5 install.log)"
[ "$(cd prefix && find . -type f)" = ./bin/parent ] || fail "installed: $(find prefix -type f)"
grep -q 'CPACK_PACKAGE_NAME "parent"' parent/CPackConfig.cmake || fail "the package is that of e2lf"

# With E2LF_INSTALL, the libraries, models and cameras are installed beside the program, which finds them there.
cmake parent -DE2LF_INSTALL=ON >configure.log 2>&1 || fail "$(grep -A 5 Error configure.log)"
cmake --install parent --component program >install.log || fail "$(tail -5 install.log)"
[ "$(prefix/bin/parent)" = "$PWD/prefix/share/e2lf/models/e2lf-n4.safetensors" ] || fail "the installed program found $(prefix/bin/parent)"
