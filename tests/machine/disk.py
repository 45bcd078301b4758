"""Disk faults: the disk becomes full before a command is done, or is read-only."""

import json
import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from runningbond.commands.terminal import BAD_INPUT, DONE

from .commands import COMMANDS
from .trial import NOT_TRIED, REDONE, REFUSED, Scratch, Trial, call, judged

FREE_BYTES = 16 << 10
"""Bytes that are left on a full disk, so that it fills up in the middle of the work [B]."""

DISK_BYTES = 8 << 20
"""Size of the disk [B]."""


class Disk:
    """A folder as a small separate disk; if it cannot be mounted, limits and permissions take its place.

    Parameters
    ----------
    folder
        The folder.
    mounts
        Whether this process may mount file systems in a namespace of its own.
    """

    def __init__(self, folder: Path, mounts: bool) -> None:
        self.folder = folder
        mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", str(folder)]
        self.mounted = mounts and subprocess.run(mount, capture_output=True, check=False).returncode == 0
        self._unlimited = resource.getrlimit(resource.RLIMIT_FSIZE)

    def fill(self) -> None:
        """Leave `FREE_BYTES` bytes; without a mount, limit each file to a fourth of them."""
        if not self.mounted:
            resource.setrlimit(resource.RLIMIT_FSIZE, (FREE_BYTES // 4, self._unlimited[1]))
            return
        free = shutil.disk_usage(self.folder).free
        (self.folder / "ballast").write_bytes(bytes(free - FREE_BYTES))

    def lock(self) -> None:
        """Make the folder read-only; without a mount, this has no effect for the superuser."""
        if self.mounted:
            self._remount("ro")
        else:
            for path in (self.folder, *self.folder.rglob("*/")):
                path.chmod(0o500)

    def mend(self) -> None:
        """Make the folder writable again."""
        resource.setrlimit(resource.RLIMIT_FSIZE, self._unlimited)
        if self.mounted:
            self._remount("rw")
        for path in (self.folder, *self.folder.rglob("*/")):
            path.chmod(0o700)
        (self.folder / "ballast").unlink(missing_ok=True)

    def _remount(self, how: str) -> None:
        subprocess.run(["mount", "-o", f"remount,{how}", str(self.folder)], check=True)


def fill(scratch: Scratch, folder: Path, disk: Disk) -> Trial:
    """Call a command on a disk that becomes full, then again with free space."""
    scratch.fresh(folder)
    disk.fill()
    code, message = call(scratch.command.arguments(folder))
    trial = scratch.trial("full disk", folder, code, message, REDONE)
    disk.mend()
    return judged(trial, code == BAD_INPUT and scratch.does_it_again(folder))


def lock(scratch: Scratch, folder: Path, disk: Disk) -> Trial:
    """Call a command in a read-only folder, then again when the folder is writable."""
    scratch.fresh(folder)
    before = sorted(folder.rglob("*"))
    disk.lock()
    code, message = call(scratch.command.arguments(folder))
    nothing = sorted(folder.rglob("*")) == before
    trial = scratch.trial("read-only folder", folder, code, message, REFUSED)
    disk.mend()
    return judged(trial, nothing and code == BAD_INPUT and scratch.does_it_again(folder))


def disk_trials(home: Path, names: Sequence[str], mounts: bool) -> list[Trial]:
    """Run prepared commands on full and on read-only disks."""
    trials: list[Trial] = []
    for scratch in (Scratch(command, home) for command in COMMANDS if command.name in names):
        for fault, happen in (("full disk", fill), ("read-only folder", lock)):
            place = home / f"{scratch.command.name}-{happen.__name__}"
            place.mkdir()
            disk = Disk(place, mounts)
            if happen is lock and not disk.mounted and os.geteuid() == 0:
                trials.append(Trial(scratch.command.name, fault, 0, len(scratch.expected), "", DONE, NOT_TRIED))
            else:
                trials.append(happen(scratch, place / "folder", disk))
    return trials


def disk_trials_apart(home: Path, names: Sequence[str]) -> list[Trial]:
    """Run `disk_trials` in a separate process, which may mount file systems if the machine allows it."""
    apart: Sequence[str] = ()
    for way in (["unshare", "--mount"], ["unshare", "--user", "--map-root-user", "--mount"]):
        if shutil.which(way[0]) and subprocess.run([*way, "true"], capture_output=True, check=False).returncode == 0:
            apart = way
            break
    program = f"""
import json
from dataclasses import asdict
from pathlib import Path
from tests.machine.disk import disk_trials
print(json.dumps([asdict(trial) for trial in disk_trials(Path({str(home)!r}), {list(names)!r}, {bool(apart)})]))
"""
    done = subprocess.run([*apart, sys.executable, "-c", program], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"trials on disks: {done.stderr}")
    return [Trial(**trial) for trial in json.loads(done.stdout.splitlines()[-1])]
