"""What `pip install .` runs (PEP 517): CMake builds the module, and this packs it as a wheel with three networks and the cameras.

Nothing but Python's own library is needed, so pip downloads nothing; Debian 12 packages no backend for CMake, such as
scikit-build-core. A build tree of this checkout that was configured for the same Python is built further; without one
build/wheel is made. --config-settings build-dir=FOLDER takes the module that a CMake build folder of e2lf holds already, and
builds nothing; platform=TAG names for which systems it is, and licences=FOLDER holds the licences of libraries in the module
(build_portable_wheel.sh).
"""
import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Folders beside share/e2lf in an environment of Python: e2lf.data_file() looks there.
# e2lf-n4-geometry is composed of the first two, and e2lf-depth reads what e2lf-depth-first has moved.
MODELS = ["e2lf-n4", "e2lf-n4-depth", "e2lf-n4-geometry", "e2lf-depth-first", "e2lf-depth"]
DATA = {"models": [f"{name}.safetensors" for name in MODELS], "cameras": ["*.json"]}
DESCRIPTION = """Light fields from the events of a camera behind a coded aperture.

The wheel contains the models e2lf-n4 and e2lf-n4-depth, e2lf-n4-geometry, which is composed of both, and e2lf-depth for any
patterns with e2lf-depth-first, so that it stays small. The others are in the folder models of the sources of e2lf: set
E2LF_MODELS to this folder, or give their paths.
"""
# Build trees that may hold the module already, the optimised ones first.
REUSED = ["wheel", "release", "dev"]
PROGRESS_S = 10


def get_requires_for_build_wheel(config_settings=None):
    return []


def version():
    return re.search(r"^project\(e2lf VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)


def interpreter():
    """The Python that the module is for: the one behind pip's environment, which has the headers."""
    return Path(sys.base_prefix) / "bin" / f"python{sys.version_info.major}.{sys.version_info.minor}"


def tell(text):
    """Says how far it is, on the terminal too: pip keeps what is printed to itself unless it is called with -v."""
    print(text, flush=True)
    try:
        with open("/dev/tty", "w") as terminal:
            terminal.write(f"\n  {text}")
    except OSError:
        pass  # no terminal: pip itself says once a minute that it is still running


def cmake(*arguments):
    """Runs CMake; its own messages say what fails."""
    # pip hides the packages of the system by PYTHONPATH. CMake asks Python for its headers and for numpy, which lie there.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    command = ["cmake", *map(str, arguments)]
    told = time.monotonic()
    try:
        with subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) as process:
            for line in process.stdout:
                print(line, end="", flush=True)
                step = re.match(r"\[(\d+)/(\d+)\]", line)
                if step and time.monotonic() - told > PROGRESS_S:
                    tell(f"e2lf: step {step[1]} of {step[2]} of the build is done")
                    told = time.monotonic()
    except FileNotFoundError:
        raise SystemExit("e2lf: cmake is not installed; `./run demo` installs what a build needs") from None
    if process.returncode != 0:
        raise SystemExit(f"e2lf: cmake failed (exit {process.returncode}) for {interpreter()}; its messages above say why")


def cached(folder):
    """What the cache of a build tree says, by name."""
    try:
        lines = (folder / "CMakeCache.txt").read_text().splitlines()
    except OSError:
        return {}
    return {entry[1]: entry[2] for entry in (re.match(r"([^#/:]+):[^=]*=(.*)", line) for line in lines) if entry}


def is_same(path, other):
    return bool(path) and Path(path).exists() and Path(path).samefile(other)


def tree_to_reuse():
    """A build tree of this very checkout that can make the module for this Python; None where there is none."""
    for name in REUSED:
        folder = ROOT / "build" / name
        cache = cached(folder)
        python = cache.get("Python_EXECUTABLE") or cache.get("_Python_EXECUTABLE")
        has_module = (cache.get("E2LF_WITH_PYTHON") in ("AUTO", "ON")
                      and not cache.get("pybind11_DIR", "NOTFOUND").endswith("NOTFOUND"))
        if has_module and is_same(cache.get("CMAKE_HOME_DIRECTORY"), ROOT) and is_same(python, interpreter()):
            return folder
    return None


def build():
    """The extension module, made by CMake for the Python that runs this. Returns its build tree."""
    folder = tree_to_reuse()
    if folder:
        tell(f"e2lf: building for {interpreter()} in {folder}, which is there already")
    else:
        folder = ROOT / "build" / "wheel"
        tell(f"e2lf: building for {interpreter()} in {folder}; the first time takes minutes")
        # The cache of a checkout that lay elsewhere is of no use.
        fresh = [] if is_same(cached(folder).get("CMAKE_HOME_DIRECTORY", ROOT), ROOT) else ["--fresh"]
        cmake(*fresh, "--preset", "release", "-B", folder, "-DE2LF_WITH_TORCH=OFF", "-DE2LF_WITH_PYTHON=ON", "-DE2LF_WITH_VIEWER=OFF",
              "-DE2LF_WITH_FILMS=OFF", f"-DPython_EXECUTABLE={interpreter()}")
    cmake("--build", folder, "-j", os.cpu_count(), "--target", "e2lf_python")
    return folder


def package(folder, prefix):
    """The package of a build folder, installed below `prefix`."""
    if not (folder / "CMakeCache.txt").exists():
        raise SystemExit(f"e2lf: {folder} is no build folder of CMake; name one in build-dir, or leave it out")
    cmake("--install", folder, "--component", "python", "--strip", "--prefix", prefix)
    found = list(Path(prefix).glob(f"**/e2lf/_e2lf{sysconfig.get_config_var('EXT_SUFFIX')}"))
    if not found:
        raise SystemExit(f"e2lf: {folder} holds no module of e2lf for {sys.executable}; build it, or name another folder")
    if cached(folder).get("BUILD_SHARED_LIBS") == "ON":  # the libraries lie beside the module, under the names that it asks for
        cmake("--install", folder, "--component", "library", "--strip", "--prefix", prefix)
        for link in [path for path in Path(prefix).glob("**/libe2lf_*") if path.is_symlink()]:
            shutil.copy(link, found[0].parent / link.name)
    return found[0].parent


def metadata():
    return (f"Metadata-Version: 2.1\nName: e2lf\nVersion: {version()}\n"
            "Summary: Light fields from the events of a camera behind a coded aperture\n"
            "License: MIT\nRequires-Python: >=3.9\nRequires-Dist: numpy\n\n" + DESCRIPTION)


def contents(package_folder, tag, licences):
    """(name in the wheel, bytes, mode) of all but the list of files."""
    data = f"e2lf-{version()}.data/data/share/e2lf"
    info = f"e2lf-{version()}.dist-info"
    for file in sorted(package_folder.rglob("*.*")):
        yield f"e2lf/{file.relative_to(package_folder)}", file.read_bytes(), 0o644
    for folder, patterns in DATA.items():
        for file in sorted(file for pattern in patterns for file in (ROOT / folder).glob(pattern)):
            yield f"{data}/{folder}/{file.name}", file.read_bytes(), 0o644
    yield f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes(), 0o644
    for file in sorted(Path(licences).iterdir()) if licences else []:
        yield f"{info}/licenses/{file.name}", file.read_bytes(), 0o644
    yield f"{info}/METADATA", metadata().encode(), 0o644
    yield f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: e2lf\nRoot-Is-Purelib: false\nTag: {tag}\n".encode(), 0o644


def tag_of(platform):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{platform.replace('-', '_').replace('.', '_')}"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    settings = config_settings or {}
    tag = tag_of(settings.get("platform", sysconfig.get_platform()))
    name = f"e2lf-{version()}-{tag}.whl"
    record = f"e2lf-{version()}.dist-info/RECORD"
    folder = Path(settings["build-dir"]).absolute() if "build-dir" in settings else build()
    lines = []
    with tempfile.TemporaryDirectory() as prefix:
        installed = package(folder, prefix)  # before the wheel exists, because it fails if the folder is another one
        with zipfile.ZipFile(Path(wheel_directory) / name, "w") as wheel:
            for path, data, mode in contents(installed, tag, settings.get("licences")):
                entry = zipfile.ZipInfo(path)
                entry.external_attr = mode << 16
                wheel.writestr(entry, data, zipfile.ZIP_DEFLATED)
                digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
                lines.append(f"{path},sha256={digest},{len(data)}\n")
            wheel.writestr(record, "".join(lines) + f"{record},,\n", zipfile.ZIP_DEFLATED)
    return name
