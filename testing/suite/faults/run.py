#!/usr/bin/env python3
"""testing/suite/faults/run.py E2LF [TRIALS] [--seed S] [--only FAULT] [--verb VERB]: the fault tests.

Runs a verb for each way of writing with each fault: TRIALS times kill -9 (200), a quarter as often each other fault. After
each, no file of the user has changed, nothing incomplete has a final name, and the command succeeds when it is repeated
and leaves only its result. Prints a table of trials and losses, also after Ctrl-C; the exit code is 1 if something was lost."""
import argparse
import collections
import pathlib
import random
import sys
import tempfile
import time

import faults
from disk import SmallDisk
from verbs import digest, files_in, prepare

PAGE_BYTES = 4096
USER_FILES = {"notes.txt": b"keep\n", "o_backup.csv": b"1,2,3,4\n", "recon_old/00_00.png": b"mine", "data.part": b"mine"}


class Machine:
    def __init__(self, e2lf, folder, dice):
        self.e2lf, self.folder, self.dice = e2lf, folder, dice
        self.losses = collections.Counter()
        self.trials = collections.Counter()

    def make_out(self, out):
        for name, data in USER_FILES.items():
            (out / name).parent.mkdir(parents=True, exist_ok=True)
            (out / name).write_bytes(data)

    def learn(self, verb):
        with tempfile.TemporaryDirectory(dir=self.folder) as name:
            out = pathlib.Path(name)
            started = time.monotonic()
            code, said = faults.end(faults.start(verb.command(out)))
            if code != 0:
                raise SystemExit(f"faults: {verb.name} fails undisturbed: {said}")
            verb.seconds = time.monotonic() - started
            verb.learn(out)

    def wrong_after_fault(self, fault, verb, out, code, was_cut):
        """What must not be after a fault; None when all is well."""
        if code < 0:
            return f"ended by signal {-code}"
        if fault in faults.MUST_SUCCEED and code != 0:
            return f"exit code {code}"
        found = [name for name in files_in(out) if name not in USER_FILES]
        for name in found:
            if name in verb.expected:
                wrong = None if was_cut else verb.damage(out, name)
                if wrong:
                    return wrong
            elif fault not in faults.MAY_LEAVE_PARTS and not was_cut:
                return f"left {name}"
            elif ".part" not in name and not was_cut:
                return f"{name} stands at a final name"
        result = (out / verb.result).exists()
        if was_cut and result and not verb.is_readable(self.e2lf, out):
            return f"{verb.result} cannot be read"
        if not was_cut and fault != "kill -9" and code == 0 and not set(verb.expected) <= set(found):
            return "exit code 0 without the whole result"
        return None

    def wrong_after_rerun(self, verb, out):
        code, said = faults.end(faults.start(verb.rerun(out)))
        if code != 0:
            return f"the rerun ends with {code}: {said.strip()[-200:]}"
        found = [name for name in files_in(out) if name not in USER_FILES]
        if found != sorted(verb.expected):
            return f"the rerun leaves other files: {sorted(set(found) ^ set(verb.expected))[:4]}"
        return next(filter(None, (verb.damage(out, name) for name in found)), None)

    def wrong_with_user_files(self, out, inputs):
        for name, data in USER_FILES.items():
            if not (out / name).exists() or (out / name).read_bytes() != data:
                return f"the user's {name} changed"
        if self.digest_inputs() != inputs:
            return "an input changed"
        return None

    def digest_inputs(self):
        inputs = [path for path in self.folder.rglob("*") if path.is_file() and "out_" not in str(path)]
        return {str(path): digest(path) for path in inputs}

    def trial(self, fault, verb, out, act, after=None):
        """One trial in a new folder; False when the fault cannot happen to this verb."""
        self.make_out(out)
        inputs = self.digest_inputs()
        code, was_cut = act(verb, out, self.dice)
        if code is None:
            return False
        wrong = self.wrong_after_fault(fault, verb, out, code, was_cut) or self.wrong_with_user_files(out, inputs)
        if after:
            after()
        wrong = wrong or self.wrong_after_rerun(verb, out) or self.wrong_with_user_files(out, inputs)
        self.trials[fault, verb.name] += 1
        if wrong:
            self.losses[fault, verb.name] += 1
            print(f"LOSS: {fault}, {verb.name}: {wrong}", flush=True)
        return True

    def repeat(self, fault, verb, act, count):
        for _ in range(count):
            with tempfile.TemporaryDirectory(prefix="out_", dir=self.folder) as name:
                if not self.trial(fault, verb, pathlib.Path(name), act):
                    return

    def fill_disks(self, verb, count):
        """A disk that is full at a random size; then there is room, and the rerun must work."""
        with tempfile.TemporaryDirectory(prefix="out_", dir=self.folder) as name:
            with SmallDisk(pathlib.Path(name)) as disk:
                self.make_out(disk.path)
                least = disk.used_bytes() + PAGE_BYTES
                faults.end(faults.start(verb.command(disk.path)))
                most = disk.used_bytes() * 5 // 4 + PAGE_BYTES
                for _ in range(count):
                    disk.empty(self.dice.randrange(least, most))
                    self.trial("full disk", verb, disk.path, faults.undisturbed, disk.grow)

    def print_table(self, fault_names, verbs):
        print(f"\n{'losses / trials':<16}" + "".join(f"{fault:>14}" for fault in fault_names))
        for verb in verbs:
            cells = [f"{self.losses[fault, verb.name]} / {self.trials[fault, verb.name]}"
                     if self.trials[fault, verb.name] else "-" for fault in fault_names]
            print(f"{verb.name:<16}" + "".join(f"{cell:>14}" for cell in cells))
        print(f"faults: {sum(self.losses.values())} losses in {sum(self.trials.values())} trials")


def run_faults(machine, names, verbs, arguments):
    for fault in names:
        if arguments.only not in (None, fault):
            continue
        count = arguments.trials if fault == "kill -9" else max(1, arguments.trials // 4)
        if fault == "full disk" and not SmallDisk.is_allowed(machine.folder):
            print("faults: full disk is SKIPPED: this machine does not let us mount a small tmpfs (root is needed)")
            continue
        for verb in verbs:
            if fault == "full disk":
                machine.fill_disks(verb, count)
            else:
                machine.repeat(fault, verb, faults.FAULTS[fault], count)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("e2lf")
    parser.add_argument("trials", nargs="?", type=int, default=200)
    parser.add_argument("--seed", type=int, default=random.randrange(1 << 32))
    parser.add_argument("--only", help="one fault")
    parser.add_argument("--verb", action="append", help="one verb; may be given again")
    arguments = parser.parse_args()
    print(f"faults: seed {arguments.seed}")
    names = [*faults.FAULTS, "full disk"]
    with tempfile.TemporaryDirectory(prefix="e2lf_faults_") as folder:
        e2lf = pathlib.Path(arguments.e2lf).resolve()
        machine = Machine(e2lf, pathlib.Path(folder), random.Random(arguments.seed))
        verbs = [verb for verb in prepare(e2lf, machine.folder) if not arguments.verb or verb.name in arguments.verb]
        for verb in verbs:
            machine.learn(verb)
        try:
            run_faults(machine, names, verbs, arguments)
        except KeyboardInterrupt:
            print("faults: ended early")
        machine.print_table(names, verbs)
    return 1 if machine.losses else 0


if __name__ == "__main__":
    sys.exit(main())
