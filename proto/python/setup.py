"""Generates the message classes from ../waymark/v1/*.proto while the package is built.

Nothing generated is kept in the repository, so nothing can be older than the messages it stands for.
"""

from importlib.resources import files
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

PROTO_ROOT = Path(__file__).resolve().parent.parent


class BuildWithMessages(build_py):
    """Runs protoc before the usual build: into the build directory, or beside the sources when editable."""

    def run(self) -> None:
        super().run()
        from grpc_tools import protoc

        target = Path("src") if self.editable_mode else Path(self.build_lib)
        target.mkdir(parents=True, exist_ok=True)
        messages = [str(path.relative_to(PROTO_ROOT)) for path in sorted(PROTO_ROOT.glob("waymark/v1/*.proto"))]
        arguments = ["protoc", f"-I{PROTO_ROOT}", f"-I{files('grpc_tools') / '_proto'}"]
        arguments += [f"--python_out={target}", f"--pyi_out={target}", *messages]
        if not messages or protoc.main(arguments) != 0:
            raise SystemExit(f"protoc failed on {PROTO_ROOT}/waymark/v1/*.proto")


setup(cmdclass={"build_py": BuildWithMessages})
