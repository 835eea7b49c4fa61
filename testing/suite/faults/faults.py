"""The faults: each runs a verb once with something going wrong. A fault returns the exit code, and whether the input was
cut (so that another result than the whole one is right). None instead of a code: not possible with this verb."""
import random
import socket
import struct
import subprocess
import threading
import time

from verbs import LIMIT_S, environment

PIECE_BYTES = 4096


def start(command, **options):
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment(), **options)


def end(process):
    """Waits for a process; its exit code and what it said."""
    _, said = process.communicate(timeout=LIMIT_S)
    return process.returncode, said.decode(errors="replace")


def undisturbed(verb, out, dice):
    """The fault is elsewhere: in the disk."""
    return end(start(verb.command(out)))[0], False


def kill(verb, out, dice):
    """kill -9 at a random moment."""
    process = start(verb.command(out))
    try:
        process.wait(dice.uniform(0, 1.1 * verb.seconds))
    except subprocess.TimeoutExpired:
        process.kill()
    end(process)
    return 0, False


def cut_pipe(verb, out, dice):
    """A pipe that ends at a random byte."""
    if not verb.streams:
        return None, False
    data = verb.source.read_bytes()
    process = start(verb.command(out, "-"), stdin=subprocess.PIPE)
    _, said = process.communicate(data[:dice.randrange(len(data))], timeout=LIMIT_S)
    return process.returncode, True


def cut_file(verb, out, dice):
    """An input file that ends at a random byte."""
    if verb.name == "train":
        victim = verb.source.parent / "packed.safetensors"
    elif verb.source.is_dir():
        victim = dice.choice(sorted(verb.source.glob("*.png")))
    else:
        victim = verb.source
    whole = victim.read_bytes()
    victim.write_bytes(whole[:dice.randrange(len(whole))])
    try:
        return end(start(verb.command(out)))[0], True
    finally:
        victim.write_bytes(whole)


def serve(send):
    """A server for one connection on a thread of its own; returns its port."""
    server = socket.socket()
    server.bind(("127.0.0.1", 0))
    server.listen(1)

    def run():
        connection, _ = server.accept()
        try:
            send(connection)
        except OSError:
            pass  # the verb ended before its input did
        connection.close()
        server.close()
    threading.Thread(target=run, daemon=True).start()
    return server.getsockname()[1]


def reset_socket(verb, out, dice):
    """A peer that resets the connection after a random byte."""
    if not verb.streams:
        return None, False
    data = verb.source.read_bytes()
    count = dice.randrange(len(data))

    def send(connection):
        connection.sendall(data[:count])
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    return end(start(verb.command(out, f"tcp://127.0.0.1:{serve(send)}")))[0], True


def slow_peer(verb, out, dice):
    """A peer that sends small pieces with pauses between them: the result is that of the whole input."""
    if not verb.streams:
        return None, False
    data = verb.source.read_bytes()
    pauses = random.Random(dice.random())

    def send(connection):
        for at in range(0, len(data), PIECE_BYTES):
            connection.sendall(data[at:at + PIECE_BYTES])
            if pauses.random() < 0.1:
                time.sleep(pauses.uniform(0, 0.05))
    return end(start(verb.command(out, f"tcp://127.0.0.1:{serve(send)}")))[0], False


def two_at_once(verb, out, dice):
    """Two processes with one output: one of them at least must succeed."""
    first = start(verb.command(out))
    time.sleep(dice.uniform(0, verb.seconds))
    second = start(verb.command(out))
    codes = [end(first)[0], end(second)[0]]
    if min(codes) < 0:
        return min(codes), False
    return min(codes), False


FAULTS = {"kill -9": kill, "cut pipe": cut_pipe, "cut file": cut_file, "socket reset": reset_socket,
          "slow peer": slow_peer, "two at once": two_at_once}
MUST_SUCCEED = {"slow peer", "two at once"}
MAY_LEAVE_PARTS = {"kill -9"}
