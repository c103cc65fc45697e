"""The scripts of recordings/README.md compute what `waymark recording report --json` says, and tables agree.

Needs the built program in the environment variable WAYMARK_BIN.
"""

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import duckdb
import pyarrow.parquet
import pytest

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "recordings" / "reference"
DRIVES = ["rink", "stop-sign"]
# Registrations hold 32-bit numbers, and the report computes distances in them.
RELATIVE = 1e-5


def waymark(*arguments):
    ran = subprocess.run([os.environ["WAYMARK_BIN"], *map(str, arguments)], check=True, capture_output=True, text=True)
    return ran.stdout


def script(name, directory):
    """The script of the README that begins with its own name."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "recordings" / "README.md").read_text(), re.DOTALL)
    [text] = [block for block in blocks if block.startswith(f"# {name}")]
    path = directory / name
    path.write_text(text)
    return path


def run(*arguments):
    ran = subprocess.run([sys.executable, *map(str, arguments)], check=True, capture_output=True, text=True)
    return json.loads(ran.stdout)


def reported(drive):
    [camera] = json.loads(waymark("recording", "report", REFERENCE / f"{drive}.mcap", "--json"))["cameras"]
    return {
        landmark["id"]: {
            "measured_rate": landmark["measured_rate"],
            "innovation_mean_px": landmark["innovation_mean_px"],
            "detection_rate": landmark["score"]["detection_rate"],
            "centre_mean_px": landmark["score"]["centre_mean_px"],
        }
        for landmark in camera["landmarks"]
    }


def assert_equal(found, expected):
    assert found.keys() == expected.keys()
    for landmark, figures in expected.items():
        assert found[landmark] == pytest.approx(figures, rel=RELATIVE)


@pytest.mark.parametrize("drive", DRIVES)
def test_figures_from_the_recording_are_those_of_the_report(drive, tmp_path):
    found = run(script("figures_from_mcap.py", tmp_path), REFERENCE / f"{drive}.mcap")
    assert_equal(found, reported(drive))


@pytest.mark.parametrize("drive", DRIVES)
def test_figures_from_parquet_are_those_of_the_report(drive, tmp_path):
    tables = []
    for table in ["registrations", "truth"]:
        tables.append(tmp_path / f"{table}.parquet")
        waymark("recording", "export", REFERENCE / f"{drive}.mcap", "--format", "parquet", "--table", table, "-o", tables[-1])
    assert_equal(run(script("figures_from_parquet.py", tmp_path), *tables), reported(drive))


@pytest.mark.parametrize("table", ["registrations", "truth"])
@pytest.mark.parametrize("drive", DRIVES)
def test_parquet_says_what_csv_says(drive, table, tmp_path):
    export = ["recording", "export", REFERENCE / f"{drive}.mcap", "--table", table]
    path = tmp_path / "table.parquet"
    waymark(*export, "--format", "parquet", "-o", path)
    expected = list(csv.DictReader(waymark(*export).splitlines()))
    by_arrow = pyarrow.parquet.read_table(path)
    by_duckdb = duckdb.execute("SELECT * FROM read_parquet($1)", [str(path)])
    names = [column[0] for column in by_duckdb.description]
    assert by_arrow.column_names == names == list(expected[0])
    rows = [list(row.values()) for row in by_arrow.to_pylist()]
    assert rows == [list(row) for row in by_duckdb.fetchall()]
    single = {field.name for field in by_arrow.schema if field.type == pyarrow.float32()}
    for row, line in zip(rows, expected, strict=True):
        for name, value in zip(names, row, strict=True):
            assert same(value, line[name], name in single), (name, value, line[name])


def same(value, text, is_single):
    if value is None or isinstance(value, str):
        return (value or "") == text
    if isinstance(value, int):
        return value == int(text)
    # The shortest text that reads back as the same number of its width.
    return pyarrow.scalar(float(text), pyarrow.float32() if is_single else pyarrow.float64()).as_py() == value


def test_the_layout_shows_topics_that_recordings_have():
    layout = json.loads((ROOT / "recordings" / "layout.json").read_text())
    shown = set(re.findall(r"/follower/[a-z/_]+", json.dumps(layout["configById"])))
    info = json.loads(waymark("recording", "info", "--json", REFERENCE / "rink.mcap"))
    recorded = {topic["topic"] for topic in info["topics"]}
    # New results come only with `register -o`.
    absent = {topic for topic in shown - recorded if not topic.endswith("/again")}
    assert not absent
    panels = re.findall(r"[A-Za-z]+![a-z]+", json.dumps(layout["layout"]))
    assert sorted(panels) == sorted(layout["configById"])
