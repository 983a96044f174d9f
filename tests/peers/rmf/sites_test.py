"""The public demo sites of Open-RMF, as `troupe check` counts them, against their files read by PyYAML.

    sites_test.py TROUPE

Their folder, of a checkout of open-rmf/rmf_demos or of its maps alone, is $TROUPE_RMF_SITES. Without it nothing is checked.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

SKIPPED = 77
SITES = ["office", "hotel", "clinic", "airport_terminal", "battle_royale", "campus", "triple_H"]
ROLES = [
    "is_charger", "is_parking_spot", "is_holding_point", "is_cleaning_zone", "is_passthrough_point", "dock_name",
    "lift_cabin", "pickup_dispenser", "dropoff_ingestor", "human_goal_set_name", "spawn_robot_name",
]
PARTS = {
    "walls": r"(\d+) walls?", "doors": r"(\d+) doors?", "floors": r"(\d+) floors?", "vertices": r"(\d+) vert",
    "lanes": r"(\d+) lanes?(?! of people)", "human_lanes": r"(\d+) lanes? of people",
}


def skip(reason):
    print(f"sites_test: {reason}; nothing was checked")
    sys.exit(SKIPPED)


def count(pattern, text):
    found = re.search(pattern, text, re.MULTILINE)
    return int(found.group(1)) if found else 0


def in_file(site):
    """The numbers of a file: by level and part, and of the whole building."""
    numbers = {"places": 0, "robots": 0, "lifts": len(site.get("lifts") or {})}
    for name, level in site["levels"].items():
        for part in PARTS:
            numbers[f"{part} of {name}"] = len(level.get(part) or [])
        for _, _, _, vertex, *more in level["vertices"]:
            values = {key: value for key, (_, value) in (more[0] if more else {}).items()}
            numbers["places"] += bool(vertex or any(values.get(role) for role in ROLES))
            numbers["robots"] += bool(values.get("spawn_robot_type"))
    return numbers


def as_checked(text, site):
    numbers = {
        "places": count(r"places: (\d+)", text),
        "robots": count(r"^robots: (\d+)", text),
        "lifts": count(r"(\d+) lifts?$", text),
    }
    for name in site["levels"]:
        line = re.search(rf"^ *level {re.escape(name)}: .*$", text, re.MULTILINE)
        for part, pattern in PARTS.items():
            numbers[f"{part} of {name}"] = count(pattern, line.group(0)) if line else 0
    return numbers


def not_the_same_when_exported(troupe, path):
    """Whether the building differs from itself as `troupe export-map --building` writes it."""
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder, "copy")
        exported = subprocess.run([troupe, "export-map", path, "-o", copy, "--building"], capture_output=True, text=True)
        if exported.returncode != 0:
            print(exported.stderr)
            return True
        hashes = []
        for file in path, copy.with_suffix(".building.yaml"):
            log = pathlib.Path(folder, "log")
            # The states have the poses of all doors, lifts, robots and people.
            subprocess.run([troupe, "run", file, "--in-process", "--headless", "--ticks", "20", "--hash-log", log],
                           check=True, capture_output=True)
            checked = subprocess.run([troupe, "check", file], capture_output=True, text=True).stdout
            parts = [line for line in checked.splitlines() if re.search(r"^(models|robots|places|  )", line)]
            hashes.append((log.read_text(), [re.sub(r"drawing [^,]*, ", "", part) for part in parts]))
        if hashes[0] == hashes[1]:
            return False
        print(f"{path}: not the same when exported")
        return True


def main():
    folder = os.environ.get("TROUPE_RMF_SITES")
    if not folder:
        skip("TROUPE_RMF_SITES is not set")
    try:
        import yaml
    except ImportError:
        skip("python3-yaml is not installed")
    wrong = 0
    for site in SITES:
        files = sorted(pathlib.Path(folder).rglob(f"{site}.building.yaml"))
        if not files:
            skip(f"found no {site}.building.yaml in {folder}")
        checked = subprocess.run([sys.argv[1], "check", files[0]], capture_output=True, text=True)
        if checked.returncode != 0:
            print(f"{site}: {checked.stdout}{checked.stderr}")
            wrong += 1
            continue
        content = yaml.safe_load(files[0].read_text())
        expected, found = in_file(content), as_checked(checked.stdout, content)
        different = {key: (expected[key], found[key]) for key in expected if expected[key] != found[key]}
        print(f"{site}: {sum(expected.values())} parts, {different or 'all counted'}")
        wrong += bool(different) + not_the_same_when_exported(sys.argv[1], files[0])
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
