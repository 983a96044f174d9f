#!/usr/bin/env python3
"""The parts of scripts/release that need no build: the SBOM names what is linked and bundled, the notes are those of the
changelog, and the checksums are those of the files.

usage: release_test.py ROOT
"""
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1])
if subprocess.run(["git", "-C", root, "rev-parse"], capture_output=True, check=False).returncode != 0:
    print("release_test: no git repository; nothing was checked")
    sys.exit(77)
with tempfile.TemporaryDirectory() as folder:
    command = [root / "scripts/release", folder, "--changed", "--only", "sbom", "notes", "sums"]
    files = []
    for _ in range(2):  # equal bytes each time
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        files.append({path.name: path.read_bytes() for path in pathlib.Path(folder).iterdir()})
    assert files[0] == files[1]
    sums = dict(reversed(line.split("  ")) for line in files[0].pop("SHA256SUMS").decode().splitlines())
    assert sums == {name: hashlib.sha256(content).hexdigest() for name, content in files[0].items()}, sums
    sbom = json.loads(next(content for name, content in files[0].items() if name.endswith(".spdx.json")))
    names = {package["name"]: package for package in sbom["packages"]}
    assert {"troupe", "three", "cyclonedds-dev"} <= names.keys(), sorted(names)
    assert "playwright-core" not in names, "it is for tests alone"
    lock = json.loads((root / "viewer/web/package-lock.json").read_text())
    assert names["three"]["versionInfo"] == lock["packages"]["node_modules/three"]["version"]
    ids = {package["SPDXID"] for package in sbom["packages"]}
    assert len(ids) == len(sbom["packages"])
    assert {each["relatedSpdxElement"] for each in sbom["relationships"]} == ids
    first = (root / "CHANGELOG.md").read_text().split("\n## ")[1].split("\n", 1)[1].strip().split("\n")[0]
    assert first in files[0]["NOTES.md"].decode()
