"""The verbs that the fault tests run, one for each way of writing: inputs, command, result, and what must hold of a result."""
import hashlib
import json
import os
import pathlib
import random
import struct
import subprocess
import tempfile

MODELS = pathlib.Path(__file__).resolve().parents[3] / "models"
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


def prepare(e2lf, folder):
    """Makes the inputs in `folder` and lists a verb for each way of writing. Training is left out of builds without torch."""
    def run(*words):
        subprocess.run([str(e2lf), *map(str, words), "--quiet"], check=True, timeout=LIMIT_S)
    run("demo", "-o", folder / "demo", "--width", 64, "--height", 48)
    scene, recording = folder / "demo" / "scene", folder / "recording.raw"
    run("simulate", scene, "-o", recording, "--cycles", 12)
    (folder / "compare.json").write_text(json.dumps({
        "methods": [{"name": "inversion", "algorithm": "inversion"}], "seeds": [1, 2, 3],
        "scenes": [{"name": "s", "scenes": [str(scene)]}]}))
    verbs = [
        Verb("convert", e2lf, ["convert", "{source}", "{result}", "--quiet"], "o.csv", recording, True),
        Verb("convert h5", e2lf, ["convert", "{source}", "{result}", "--quiet"], "o.hdf5", recording, True),
        Verb("accumulate", e2lf, ["accumulate", "{source}", "-o", "{result}", "--source", "triggers", "--quiet"],
             "events.npz", recording, True),
        Verb("reconstruct", e2lf, ["reconstruct", "{source}", "-o", "{result}", "--source", "triggers", "--method",
                                   "inversion", "--max-cycles", "4", "--quiet"], "recon", recording, True),
        Verb("model export", e2lf, ["model", "export", "{source}", "-o", "{result}", "--quiet"], "model.onnx",
             MODELS / "e2lf-n4.safetensors", False),
        Verb("epi", e2lf, ["epi", "{source}", "-o", "{result}", "--quiet"], "epi.png", scene, False),
        Comparison("compare", e2lf, ["compare", "{source}", "-o", "{result}", "--quiet"], "tables",
                   folder / "compare.json", False),
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
