# pip install .: a wheel of the module that this build holds, in an environment of its own, without the network.
[ -d "$E2LF_BUILD/python/e2lf" ] || skip "the build has no Python package"
skip_sanitizers "the module needs the sanitizers' libraries"
py -m venv --system-site-packages environment >venv.txt 2>&1 || skip "python3-venv is not installed"
export PIP_NO_INDEX=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_CACHE_DIR=$PWD/cache PYTHONPATH=
environment/bin/python -m pip wheel "$SOURCES" --config-settings build-dir="$E2LF_BUILD" --no-deps -w wheels >pip.txt 2>&1 ||
  fail "$(tail -5 pip.txt)"
[ "$(cat wheels/*.whl | wc -c)" -le 30000000 ] || fail "the wheel has $(cat wheels/*.whl | wc -c) bytes"
environment/bin/python -m pip install wheels/e2lf-*.whl >pip.txt 2>&1 || fail "$(tail -5 pip.txt)"
mkdir empty
cd empty
# The module loads nothing that only programs need: films, the display, the web server.
objdump -p ../environment/lib/python*/site-packages/e2lf/_e2lf*.so >needed.txt
if grep -E 'NEEDED.*(libav|libsw|SDL|httplib|torch)' needed.txt; then fail "a library of the programs"; fi
# Every file is as the wheel's list says, and what comes with e2lf lies in the environment.
in_clean_root ../environment/bin/python - <<'PY' || fail "the installed wheel"
import base64, hashlib, importlib.metadata, os, sys
import numpy as np
import e2lf
assert e2lf.__file__.startswith(sys.prefix) and e2lf.bundled_model().startswith(sys.prefix), e2lf.__file__
about = importlib.metadata.distribution("e2lf")
assert about.version == e2lf.__version__, about.version
listed = [file for file in about.files if file.hash]
assert {file.name for file in listed} >= {"py.typed", "__init__.pyi", "e2lf-depth.safetensors", "evk4-lcos.json", "LICENSE"}
for file in listed:
    digest = base64.urlsafe_b64encode(hashlib.sha256(file.read_binary()).digest()).rstrip(b"=").decode()
    assert digest == file.hash.value, file
assert sorted(file.stem for file in listed if file.suffix == ".safetensors") == ["e2lf-depth", "e2lf-depth-first", "e2lf-n4", "e2lf-n4-depth", "e2lf-n4-geometry"]
try:
    e2lf.Model("e2lf-n4-camera")
except e2lf.Error as error:
    assert "E2LF_MODELS" in error.message, error
model = e2lf.read_model(e2lf.bundled_model())
images = e2lf.simulate(e2lf.demo_scene(48, 32), model.codes, constants=model.constants)
assert np.isfinite(e2lf.Reconstructor(model).reconstruct(images)).all()
PY
../environment/bin/python -m pip uninstall -y e2lf >pip.txt 2>&1
if ../environment/bin/python -c "import e2lf" 2>/dev/null; then fail "files of e2lf stayed behind"; fi
# What cannot be built says why.
mkdir -p wrong no-cmake
wrong() {
  if ../environment/bin/python -m pip wheel "$SOURCES" "$@" --no-deps -w wheels >pip.txt 2>&1; then fail "built: $*"; fi
}
wrong --config-settings build-dir="$PWD/wrong"
grep -q "wrong is no build folder of CMake" pip.txt || fail "$(tail -5 pip.txt)"
PATH=$PWD/no-cmake wrong
grep -q "cmake is not installed" pip.txt || fail "$(tail -5 pip.txt)"
# A plain `pip install .` finds Python's headers and numpy, which pip hides from it. It ends where CMake would compile.
mkdir no-compiling plain
cat >no-compiling/cmake <<SH
#!/bin/sh
echo "cmake \$*" >>"$PWD/called.txt"
[ "\$1" != --build ] || { echo "[1/2] compiling"; exit 1; }
exec "$(command -v cmake)" "\$@"
SH
chmod +x no-compiling/cmake
for name in "$SOURCES"/*; do
  case ${name##*/} in build | python | pyproject.toml | CMake*) ;; *) ln -s "$name" plain/ ;; esac
done
cp -r "$SOURCES"/{python,pyproject.toml,CMakeLists.txt,CMakePresets.json} plain
plain() {
  : >called.txt
  if PATH=$PWD/no-compiling:$PATH ../environment/bin/python -m pip wheel "$PWD/plain" --no-deps -w wheels >pip.txt 2>&1; then fail "built"; fi
}
python=$(py -c 'import os, sys; print(os.path.realpath(sys.executable))')
plain
grep -q "python: ON" pip.txt || fail "$(tail -20 pip.txt)"
grep -q "cmake failed (exit 1) for $python" pip.txt || fail "no interpreter: $(tail -20 pip.txt)"
grep -q -- "--preset release -B $PWD/plain/build/wheel" called.txt || fail "$(cat called.txt)"
# The second time, and where another build of this checkout has the module, that tree is built further; not one of another
# checkout.
plain
[ "$(sed "s/-j [0-9]*/-j N/" called.txt)" = "cmake --build $PWD/plain/build/wheel -j N --target e2lf_python" ] || fail "$(cat called.txt)"
mv plain/build/wheel plain/build/release
plain
grep -q -- "^cmake --build $PWD/plain/build/release " called.txt || fail "$(cat called.txt)"
sed -i "s|^CMAKE_HOME_DIRECTORY:.*|CMAKE_HOME_DIRECTORY:INTERNAL=$PWD/empty|" plain/build/release/CMakeCache.txt
plain
grep -q -- "--preset release -B $PWD/plain/build/wheel" called.txt || fail "$(cat called.txt)"
# pip keeps what a build prints: the terminal is told how far it is.
cat >told.py <<'PY'
import os, pty, sys
pid, terminal = pty.fork()  # a terminal that the child's /dev/tty is
if pid == 0:
    sys.path.insert(0, "plain/python")
    import build_wheel
    build_wheel.PROGRESS_S = 0
    sys.stdout = open(os.devnull, "w")
    build_wheel.cmake("--build", "nowhere")
    sys.exit(0)
told = b""
try:
    while data := os.read(terminal, 4096):
        told += data
except OSError:
    pass
os.waitpid(pid, 0)
sys.exit(b"step 1 of 2 of the build is done" not in told)
PY
PATH=$PWD/no-compiling:$PATH py told.py || fail "nothing on the terminal"
# What Python lacks is said of the interpreter that was tried.
"$(command -v cmake)" -S plain -B no-headers -G Ninja -DE2LF_WITH_PYTHON=ON -DE2LF_WITH_TORCH=OFF -DE2LF_WITH_VIEWER=OFF \
  -DE2LF_BUILD_TESTS=OFF -DPython_EXECUTABLE="$PWD/environment/bin/python-none" >cmake.txt 2>&1 && fail "built without Python"
# CMake breaks long messages into lines.
tr -s ' \n' ' ' <cmake.txt | grep -F "for $PWD/environment/bin/python-none" >/dev/null || fail "$(tail -20 cmake.txt)"
