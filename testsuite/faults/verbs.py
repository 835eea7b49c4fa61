"""What the machine of faults runs: each verb's inputs, command and result, and what must hold of a result."""
import hashlib
import json
import os
import pathlib
import random
import struct
import subprocess
import tempfile

MODELS = pathlib.Path(__file__).resolve().parents[2] / "models"
LIMIT_S = 1800  # what hangs ends here; a run takes seconds


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def files_in(folder):
    """Relative names of all files below a folder."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir())


def is_record(name):
    """A run.json holds times, so no two are the same."""
    return name.endswith("run.json")


class Verb:
    """One command that writes `result` (a file or folder) into the output folder. `source` stands for the input."""

    def __init__(self, name, program, arguments, result, source, streams):
        self.name, self.program, self.arguments = name, program, arguments
        self.result, self.source, self.streams = result, source, streams
        self.expected = {}  # what an undisturbed run writes: name -> digest, None for what differs each time
        self.seconds = 0.0

    def command(self, out, source=None, overwrite=False):
        values = {"source": str(source or self.source), "result": str(out / self.result)}
        words = [word.format(**values) for word in self.arguments]
        return [str(self.program), *words, *(["--overwrite"] if overwrite else [])]

    def rerun(self, out):
        """The command that a user gives after a fault."""
        return self.command(out, overwrite=any((out / name).exists() for name in self.expected))

    def digest_of(self, out, name):
        if is_record(name):
            return None
        return self.digest_of_hdf5(out / name) if name.endswith(".hdf5") else digest(out / name)

    def digest_of_hdf5(self, path):
        """Of what is in it: the HDF5 library leaves some bytes of its files undefined."""
        with tempfile.TemporaryDirectory() as folder:
            text = pathlib.Path(folder) / "events.csv"
            subprocess.run([str(self.program), "convert", str(path), str(text), "--quiet"], capture_output=True,
                           check=False, timeout=LIMIT_S)
            return "".join(digest(part) for part in sorted(text.parent.glob("*.csv")))

    def learn(self, out):
        """Takes what lies in `out` after an undisturbed run as what is expected."""
        self.expected = {name: self.digest_of(out, name) for name in files_in(out)}

    def damage(self, out, name):
        """What is wrong with a file of the result that was written from the whole input, or None."""
        path = out / name
        if is_record(name):
            try:
                json.loads(path.read_text())
            except ValueError:
                return f"{name} is no JSON"
        elif self.digest_of(out, name) != self.expected[name]:
            return f"{name} is not what an undisturbed run writes"
        return None

    def is_readable(self, e2lf, out):
        """Whether the result, of an input that was cut, can be read."""
        paths = [out / self.result]
        if paths[0].is_dir():
            paths = sorted(path for path in paths[0].iterdir() if path.is_dir()) or paths
        return all(subprocess.run([e2lf, "info", str(path), "--json"], capture_output=True, check=False,
                                  timeout=LIMIT_S).returncode == 0 for path in paths)


class Frames(Verb):
    """A folder of frames, which no other verb reads."""

    def is_readable(self, e2lf, out):
        rows = (out / self.result / "frames.csv").read_text().splitlines()[1:]
        frames = sorted((out / self.result).glob("*.png"))
        return len(frames) == len(rows) > 0 and all(frame.read_bytes()[-8:-4] == b"IEND" for frame in frames)


class Comparison(Verb):
    """A folder that grows: what is there stays, and the same command goes on. Results and pages hold times."""

    def rerun(self, out):
        return self.command(out)

    def digest_of(self, out, name):
        return digest(out / name) if name.endswith(".csv") else None

    def damage(self, out, name):
        data = (out / name).read_bytes()
        if name.endswith(".json"):
            try:
                json.loads(data)
            except ValueError:
                return f"{name} is no JSON"
        elif name.endswith(".png") and data[-8:-4] != b"IEND":
            return f"{name} is cut"
        elif name.endswith(".html") and not data.rstrip().endswith(b"</html>"):
            return f"{name} is cut"
        return super().damage(out, name) if name.endswith(".csv") else None

    def is_readable(self, e2lf, out):
        return True


class Training(Verb):
    """A run folder. Its figures depend on the machine's threads, so that the model is read rather than compared."""

    def rerun(self, out):
        run = out / self.result
        if (run / "checkpoint.safetensors").exists():
            return [str(self.program), "resume", str(run)]
        return self.command(out)

    def digest_of(self, out, name):
        return None

    def damage(self, out, name):
        path = out / name
        if path.suffix == ".safetensors":
            data = path.read_bytes()
            size = struct.unpack("<Q", data[:8])[0] if len(data) >= 8 else 0
            try:
                header = json.loads(data[8:8 + size])
                ends = [entry["data_offsets"][1] for key, entry in header.items() if key != "__metadata__"]
            except ValueError:
                return f"{name} has no header"
            return None if max(ends, default=0) == len(data) - 8 - size else f"{name} is cut"
        if path.suffix == ".json":
            try:
                json.loads(path.read_text())
            except ValueError:
                return f"{name} is no JSON"
        return None

    def is_readable(self, e2lf, out):
        return True


def write_training_data(folder):
    """Packed light fields and a configuration of a network that trains in a second."""
    generator = random.Random(1)
    tensors = {f"lightfield/{name}": generator.randbytes(64 * 40 * 40) for name in "ab"}
    header, at = {}, 0
    for name, data in tensors.items():
        header[name] = {"dtype": "U8", "shape": [8, 8, 40, 40], "data_offsets": [at, at + len(data)]}
        at += len(data)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    (folder / "packed.safetensors").write_bytes(struct.pack("<Q", len(text)) + text + b"".join(tensors.values()))
    config = {"name": "tiny",
              "data": {"file": str(folder / "packed.safetensors"), "validation": ["a"], "synthetic_share": 0.5, "pool": 4,
                       "synthesiser": {"size": 32}},
              "patterns": {"begin_step": 2, "learn_steps": 8},
              "network": {"widths": [8, 8], "blocks": [1, 1], "head_width": 4},
              "train": {"patch": 16, "batch": 4, "steps": 12, "warmup_steps": 2, "log_steps": 1, "evaluate_steps": 6,
                        "checkpoint_steps": 2}}
    (folder / "train.json").write_text(json.dumps(config))


def write_calibration_data(folder):
    """A light field of fifteen even patches, and three patterns after black that pass an eighth, three quarters and a quarter."""
    height, width = 75, 100
    row = [[0.01 * 1.35 ** ((y // 25 * 5 + x // 20) * 7 % 15) for x in range(width)] for y in range(height)]
    view = struct.pack(f"<{height * width}f", *(value for line in row for value in line))
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': (8, 8, {height}, {width}), }}"
    header = header.ljust(117) + "\n"
    (folder / "patches.npy").write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + 64 * view)
    open_cells = [0, 8, 48, 16]
    patterns = [["".join("1" if row * 8 + column < count else "0" for column in range(8)) for row in range(8)]
                for count in open_cells]
    (folder / "codes.json").write_text(json.dumps({"patterns": patterns}))


def can(program, folder, *words):
    """Whether the build can do this, with an output that is named last: some parts are left out where a library is missing."""
    with tempfile.TemporaryDirectory(dir=folder) as out:
        command = [str(program), *map(str, words[:-1]), f"{out}/{words[-1]}"]
        return subprocess.run(command, capture_output=True, check=False, timeout=LIMIT_S).returncode == 0


def newer_verbs(e2lf, folder, run):
    """What makes pictures, numbers and tables of light fields and event images."""
    scene = folder / "demo" / "scene"
    write_calibration_data(folder)
    run("simulate", folder / "patches.npy", "--codes", folder / "codes.json", "--camera", "evk4-lcos", "--cycles", 4, "-o",
        folder / "still.npz")
    (folder / "compare.json").write_text(json.dumps({
        "methods": [{"name": "inversion", "algorithm": "inversion"}], "seeds": [1, 2, 3],
        "scenes": [{"name": "s", "scenes": [str(scene)]}]}))
    def verb(name, *words, result, source=scene):
        return Verb(name, e2lf, [*words, "--quiet"], result, source, False)
    verbs = [
        verb("depth", "depth", "{source}", "-o", "{result}", result="depth"),
        verb("depth ply", "depth", "{source}", "-o", "{result}", result="points.ply"),
        verb("refocus", "refocus", "{source}", "--disparity=-1,0", "-o", "{result}", result="near.png"),
        verb("epi", "epi", "{source}", "-o", "{result}", result="epi.png"),
        verb("codes render", "codes", "render", "--codes", "{source}", "-o", "{result}", result="display",
             source=folder / "codes.json"),
        verb("calibrate", "calibrate", "{source}", "--even", "-o", "{result}", result="mine.json",
             source=folder / "still.npz"),
        Comparison("compare", e2lf, ["compare", "{source}", "-o", "{result}", "--quiet"], "tables",
                   folder / "compare.json", False),
    ]
    film = "film.gif" if can(e2lf, folder, "animate", scene, "--frames", 1, "-o", "x.gif") else "quilt_qs4x2a1.33.png"
    shape = ["--frames", "6"] if film.endswith(".gif") else ["--columns", "4", "--rows", "2"]
    verbs.append(verb("animate", "animate", "{source}", "-o", "{result}", *shape, result=film))
    if can(e2lf, folder, "view", scene, "--export", "x.html"):
        verbs.append(verb("view", "view", "{source}", "--export", "{result}", result="page.html"))
    else:
        print("faults: this build has no viewer: view is left out")
    return verbs


def prepare(e2lf, folder):
    """Makes the inputs in `folder` and lists the verbs. Training is left out where e2lf was built without torch."""
    def run(*words):
        subprocess.run([str(e2lf), *map(str, words), "--quiet"], check=True, timeout=LIMIT_S)
    run("demo", "-o", folder / "demo", "--width", 64, "--height", 48)
    scene, recording = folder / "demo" / "scene", folder / "recording.raw"
    run("simulate", scene, "-o", recording, "--cycles", 12)
    verbs = [
        Verb("convert", e2lf, ["convert", "{source}", "{result}", "--quiet"], "o.csv", recording, True),
        Verb("convert h5", e2lf, ["convert", "{source}", "{result}", "--quiet"], "o.hdf5", recording, True),
        Verb("accumulate", e2lf, ["accumulate", "{source}", "-o", "{result}", "--source", "triggers", "--quiet"],
             "events.npz", recording, True),
        Verb("reconstruct", e2lf, ["reconstruct", "{source}", "-o", "{result}", "--source", "triggers", "--method",
                                   "inversion", "--max-cycles", "4", "--quiet"], "recon", recording, True),
        Frames("video", e2lf, ["video", "{source}", "-o", "{result}", "--window-us", "20000", "--quiet"], "frames",
               recording, True),
        Verb("simulate", e2lf, ["simulate", "{source}", "-o", "{result}", "--cycles", "4", "--quiet"],
             "simulated.npz", scene, False),
        Verb("convert mat", e2lf, ["convert", "{source}", "{result}", "--quiet"], "o.mat", scene, False),
        Verb("model export", e2lf, ["model", "export", "{source}", "-o", "{result}", "--quiet"], "model.onnx",
             MODELS / "e2lf-n4.safetensors", False),
        *newer_verbs(e2lf, folder, run),
    ]
    trainer = pathlib.Path(e2lf).parent / "e2lf-train"
    if trainer.exists():
        write_training_data(folder)
        verbs.append(Training("train", trainer, ["train", "{source}", "-o", "{result}"], "run", folder / "train.json",
                              False))
    else:
        print("faults: no e2lf-train beside e2lf (built without torch): train is left out")
    return verbs


def environment():
    """One thread, so that many trials fit beside each other and a result is the same each time."""
    return {**os.environ, "OMP_NUM_THREADS": "1"}
