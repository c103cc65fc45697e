"""Images for the container tests, where no registry can be reached.

Nothing is pulled: `busybox` is made from this machine's static busybox and the C library that the binary asks for, and
the Eclipse router from a zenohd built with cargo. So these tests prove our Dockerfile's steps, the compose file and the
services, not the upstream images.
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
ZENOHD = "zenohd:test"
STAND_IN = "waymark.stand-in"
"""Label of what is made here, and may be made anew."""


def build_waymark(binary: Path) -> None:
    """Our image from a binary already built, on a stand-in of its base image unless the real one is there."""
    if is_ours(BASE):
        import_root(BASE, shared_libraries(binary), [])
    with tempfile.TemporaryDirectory() as context:
        shutil.copy(binary, f"{context}/waymark")
        subprocess.run(["strip", f"{context}/waymark"], check=True)
        command = ["docker", "build", "--quiet", "--tag", WAYMARK, "--target", "prebuilt"]
        # The builder that every engine has.
        environment = {**os.environ, "DOCKER_BUILDKIT": "0"}
        subprocess.run([*command, "--file", ROOT / "Dockerfile", context], check=True, env=environment)


def build_zenohd(binary: Path) -> None:
    """What stands in for the image of the Eclipse router: the same program, started the same way."""
    change = f'ENTRYPOINT ["{binary}"]'
    import_root(ZENOHD, [binary, *shared_libraries(binary)], ["--change", change])


def is_ours(image: str) -> bool:
    """Whether the image may be made anew: it is not there, or was made here."""
    form = f'{{{{index .Config.Labels "{STAND_IN}"}}}}'
    inspected = subprocess.run(["docker", "image", "inspect", "-f", form, image], capture_output=True, text=True)
    return inspected.returncode != 0 or inspected.stdout.strip() == "yes"


def import_root(image: str, files: list[Path], options: list[str]) -> None:
    """An image of busybox and of these files, each at its own place."""
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
        for file in files:
            target = root / file.relative_to("/")
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, target)
        with tempfile.TemporaryFile() as archive:
            with tarfile.open(fileobj=archive, mode="w") as tar:
                tar.add(root, arcname=".")
            archive.seek(0)
            command = ["docker", "import", "--change", f"LABEL {STAND_IN}=yes", *options, "-", image]
            subprocess.run(command, stdin=archive, stdout=subprocess.DEVNULL, check=True)


def shared_libraries(binary: Path) -> list[Path]:
    """What the dynamic linker loads for it; nothing for a static binary."""
    listed = subprocess.run(["ldd", binary], capture_output=True, text=True).stdout
    return [Path(word) for word in listed.split() if word.startswith("/") and Path(word).is_file()]
