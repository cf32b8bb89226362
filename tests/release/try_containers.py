"""Do what the Dockerfile says in a Debian 12 of its own: ``python -m tests.release.try_containers FOLDER [BOUND…]``.

Needs root and debootstrap. The base image is made from this machine's package mirror, and each step runs in a mount
namespace of its own, changed to that root: nothing outside FOLDER is written. Folders that pip's configuration names
can be bound into it, to be read. At the end the container's program makes one episode, as a user without rights.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from tests.release.recipes import dockerfile
from tests.run_folders import REPOSITORY
from vcage.setup import apt_sources

USER = "65534:65534"
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
CERTIFICATES = "/certificates-of-this-machine.crt"
RUN = ["run", "Put the apple into the bowl", "--episodes", "1", "--models", "offline", "--out", "run"]
SOURCES = "Types: deb\nURIs: {mirror}\nSuites: bookworm bookworm-updates\nComponents: main\nSigned-By: {key}\n"
KEY = "/usr/share/keyrings/debian-archive-keyring.gpg"


def main() -> int:
    """Build and try the container; the exit code is that of the first step that fails."""
    root, bound = Path(sys.argv[1]).resolve() / "root", [Path(name) for name in sys.argv[2:]]
    mirror = next(source["uris"].split()[0] for source in apt_sources.read())
    subprocess.run(["debootstrap", "--variant=minbase", "bookworm", root, mirror], check=True)
    # As Debian's image has it.
    (root / "etc/apt/sources.list").unlink()
    (root / "etc/apt/sources.list.d/debian.sources").write_text(SOURCES.format(mirror=mirror, key=KEY))
    shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
    _copy_pips_configuration(root)
    recipe = dockerfile()
    for source, target in recipe.files:
        _copy(REPOSITORY / source, root / target.lstrip("/"))
    for step in recipe.steps:
        inside(root, bound, recipe.arguments, ["sh", "-ec", step])
    variables = {"HOME": "/nowhere", **recipe.variables}
    for words in (["--version"], ["doctor"], RUN):
        inside(root, [], variables, [recipe.program, *words], user=USER, folder="/data")
    return 0


def inside(
    root: Path,
    bound: list[Path],
    variables: dict[str, str],
    command: list[str],
    *,
    user: str = "0:0",
    folder: str = "/",
) -> None:
    """Run a command in the root, with these variables, pip's own and no others.

    Raises:
        CalledProcessError: it failed.
    """
    for path in bound:
        (root / path.relative_to("/")).mkdir(parents=True, exist_ok=True)
    mounts = "".join(f"mount --bind -o ro {path} {root}{path}\n" for path in bound)
    mounts += f"mount -t proc proc {root}/proc\nmount --rbind /dev {root}/dev\n"
    chroot = f'exec chroot --userspec={user} {root} sh -c \'cd "$0" && exec "$@"\' {folder} "$@"'
    kept = {name: value for name, value in os.environ.items() if name.startswith("PIP_")}
    environment = {"PATH": PATH, **kept, "PIP_CERT": CERTIFICATES, **variables}
    begun = time.perf_counter()
    program = ["unshare", "--mount", "--pid", "--fork", "sh", "-ec", mounts + chroot, "sh", *command]
    subprocess.run(program, env=environment, check=True)
    print(f"{' '.join(command)[:80]}: {time.perf_counter() - begun:.0f} s", file=sys.stderr)


def _copy_pips_configuration(root: Path) -> None:
    """Give the root this machine's index and certificates."""
    for name in ("/etc/pip.conf", "/etc/xdg/pip"):
        if Path(name).exists():
            _copy(Path(name), root / name.lstrip("/"))
    # Under a name that no package of the container writes over.
    _copy(Path("/etc/ssl/certs/ca-certificates.crt"), root / CERTIFICATES.lstrip("/"))


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    else:
        shutil.copy(source, target)


if __name__ == "__main__":
    sys.exit(main())
