"""Images for the container tests, where no registry can be reached.

Nothing is pulled: `busybox` is made from this machine's static busybox and its C library, and the router is Waymark's
own. So these tests prove our Dockerfile's steps, the compose file and the services, not the upstream images.
"""

import os
import shutil
import subprocess
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BASE = "busybox:1.36"
WAYMARK = "waymark:test"


def build_all(binary: Path) -> None:
    """Makes the stand-in of the base image when it is not there, and ours from a binary already built."""
    if subprocess.run(["docker", "image", "inspect", BASE], capture_output=True).returncode != 0:
        make_base(binary)
    with tempfile.TemporaryDirectory() as context:
        shutil.copy(binary, f"{context}/waymark")
        subprocess.run(["strip", f"{context}/waymark"], check=True)
        command = ["docker", "build", "--quiet", "--tag", WAYMARK, "--target", "prebuilt"]
        subprocess.run([*command, "--file", ROOT / "Dockerfile", context], check=True, env=plain_builder())


def make_base(binary: Path) -> None:
    """A root file system of busybox, and of the shared libraries that the binary asks for."""
    busybox = shutil.which("busybox")
    if busybox is None:
        raise RuntimeError("busybox is missing; install it (Debian: apt-get install busybox-static)")
    with tempfile.TemporaryDirectory() as directory:
        root = Path(directory)
        for folder in ("bin", "tmp", "etc", "usr/local/bin"):
            (root / folder).mkdir(parents=True)
        (root / "tmp").chmod(0o1777)
        shutil.copy(busybox, root / "bin/busybox")
        for applet in subprocess.check_output([busybox, "--list"], text=True).split():
            if applet != "busybox":
                (root / "bin" / applet).symlink_to("/bin/busybox")
        for library in shared_libraries(binary):
            target = root / library.relative_to("/")
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(library, target)
        with tempfile.TemporaryFile() as archive:
            with tarfile.open(fileobj=archive, mode="w") as tar:
                tar.add(root, arcname=".")
            archive.seek(0)
            subprocess.run(["docker", "import", "-", BASE], stdin=archive, stdout=subprocess.DEVNULL, check=True)


def shared_libraries(binary: Path) -> list[Path]:
    """What the dynamic linker loads for it; nothing for a static binary."""
    listed = subprocess.run(["ldd", binary], capture_output=True, text=True).stdout
    return [Path(word) for word in listed.split() if word.startswith("/") and Path(word).is_file()]


def plain_builder() -> dict[str, str]:
    """The builder that every engine has."""
    return {**os.environ, "DOCKER_BUILDKIT": "0"}
