"""What `pip install .` runs (PEP 517): CMake builds the module, and this packs it as a wheel with the models and cameras.

Nothing but Python's own library is needed, so pip downloads nothing. --config-settings build-dir=FOLDER takes the module
that a CMake build folder of e2lf holds already, in place of building it in build/wheel.
"""
import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Folders beside share/e2lf in an environment of Python: e2lf.data_file() looks there.
DATA = {"models": "*.safetensors", "cameras": "*.json"}


def get_requires_for_build_wheel(config_settings=None):
    return []


def version():
    return re.search(r"^project\(e2lf VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)


def cmake(*arguments):
    """Runs CMake; its own messages say what fails."""
    # pip hides the packages of the system by PYTHONPATH. CMake asks Python for its headers and for numpy, which lie there.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    try:
        subprocess.run(["cmake", *map(str, arguments)], cwd=ROOT, env=environment, check=True)
    except FileNotFoundError:
        raise SystemExit("e2lf: cmake is not installed; `./run demo` installs what a build needs") from None
    except subprocess.CalledProcessError as error:
        raise SystemExit(f"e2lf: cmake failed (exit {error.returncode}); its messages above say why") from None


def build(folder):
    """The extension module, made by CMake for the Python that runs this."""
    python = Path(sys.base_prefix) / "bin" / f"python{sys.version_info.major}.{sys.version_info.minor}"
    cmake("--preset", "minimal", "-B", folder, "-DE2LF_WITH_PYTHON=ON", "-DE2LF_WITH_VIEWER=OFF", "-DE2LF_WITH_FILMS=OFF",
          f"-DPython_EXECUTABLE={python}")
    cmake("--build", folder, "-j", os.cpu_count(), "--target", "e2lf_python")


def package(folder, prefix):
    """The package of a build folder, installed below `prefix`."""
    if not (folder / "CMakeCache.txt").exists():
        raise SystemExit(f"e2lf: {folder} is no build folder of CMake; name one in build-dir, or leave it out")
    cmake("--install", folder, "--component", "python", "--strip", "--prefix", prefix)
    found = list(Path(prefix).glob(f"**/e2lf/_e2lf{sysconfig.get_config_var('EXT_SUFFIX')}"))
    if not found:
        raise SystemExit(f"e2lf: {folder} holds no module of e2lf for {sys.executable}; build it, or name another folder")
    return found[0].parent


def metadata():
    return (f"Metadata-Version: 2.1\nName: e2lf\nVersion: {version()}\n"
            "Summary: Light fields from the events of a camera behind a coded aperture\n"
            "License: MIT\nRequires-Python: >=3.9\nRequires-Dist: numpy\n")


def contents(package_folder):
    """(name in the wheel, bytes, mode) of all but the list of files."""
    data = f"e2lf-{version()}.data/data/share/e2lf"
    info = f"e2lf-{version()}.dist-info"
    for file in sorted(package_folder.iterdir()):
        yield f"e2lf/{file.name}", file.read_bytes(), 0o644
    for folder, pattern in DATA.items():
        for file in sorted((ROOT / folder).glob(pattern)):
            yield f"{data}/{folder}/{file.name}", file.read_bytes(), 0o644
    yield f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes(), 0o644
    yield f"{info}/METADATA", metadata().encode(), 0o644
    yield f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: e2lf\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode(), 0o644


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    name = f"e2lf-{version()}-{tag()}.whl"
    record = f"e2lf-{version()}.dist-info/RECORD"
    settings = config_settings or {}
    folder = Path(settings.get("build-dir", ROOT / "build" / "wheel")).absolute()
    if "build-dir" not in settings:
        build(folder)
    lines = []
    with tempfile.TemporaryDirectory() as prefix, zipfile.ZipFile(Path(wheel_directory) / name, "w") as wheel:
        for path, data, mode in contents(package(folder, prefix)):
            entry = zipfile.ZipInfo(path)
            entry.external_attr = mode << 16
            wheel.writestr(entry, data, zipfile.ZIP_DEFLATED)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            lines.append(f"{path},sha256={digest},{len(data)}\n")
        wheel.writestr(record, "".join(lines) + f"{record},,\n", zipfile.ZIP_DEFLATED)
    return name
