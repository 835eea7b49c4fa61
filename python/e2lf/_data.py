"""Models and cameras that come with e2lf."""
from os import PathLike, fspath
from pathlib import Path
from typing import Union

from . import _e2lf


def data_file(name: str) -> str:
    """The path of a file that comes with e2lf.

    name: with its folder, such as "models/e2lf-n4.safetensors" or "cameras/evk4-lcos.json".
    """
    package = Path(__file__).resolve().parent
    folders = [*(parent / "share" / "e2lf" for parent in package.parents), Path(_e2lf._source_tree)]
    for folder in folders:
        if (folder / name).exists():
            return str(folder / name)
    raise FileNotFoundError(f"{name} does not come with this installation of e2lf; give the path of a file")


def bundled_model(name: str = "e2lf-n4") -> str:
    """The path of a bundled model.

    name: "e2lf-n4", "e2lf-n4-camera", "e2lf-n4-capture", "e2lf-n4-capture-black" or "e2lf-n8"; docs/models.md says which
    is for what.
    """
    return data_file(f"models/{name}.safetensors")


def read_camera(name: Union[str, "PathLike[str]"]) -> _e2lf.Camera:
    """Reads a camera.

    name: the path of a camera file, or the name of a bundled camera: "evk4-lcos", "ideal", "paper".
    """
    path = fspath(name)
    if "/" not in path and not Path(path).exists():
        try:
            path = data_file(f"cameras/{path}.json")
        except FileNotFoundError:
            pass
    return _e2lf._read_camera(path)
