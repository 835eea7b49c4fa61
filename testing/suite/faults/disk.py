"""A small disk in memory that can be full at any size."""
import os
import pathlib
import subprocess


class SmallDisk:
    ROOM_BYTES = 256 << 20

    def __init__(self, path):
        self.path = path

    def __enter__(self):
        self.mount(self.ROOM_BYTES)
        return self

    def __exit__(self, *_):
        self.unmount()

    @staticmethod
    def is_allowed(folder):
        path = pathlib.Path(folder) / "disk"
        path.mkdir()
        try:
            with SmallDisk(path):
                return True
        except (OSError, subprocess.CalledProcessError):
            return False
        finally:
            path.rmdir()

    def mount(self, size):
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "e2lf_faults", str(self.path)], check=True,
                       capture_output=True)

    def unmount(self):
        subprocess.run(["umount", str(self.path)], check=True, capture_output=True)

    def empty(self, size):
        """A new disk of so many bytes."""
        self.unmount()
        self.mount(size)

    def grow(self):
        subprocess.run(["mount", "-o", f"remount,size={self.ROOM_BYTES}", str(self.path)], check=True,
                       capture_output=True)

    def used_bytes(self):
        state = os.statvfs(self.path)
        return (state.f_blocks - state.f_bfree) * state.f_frsize
