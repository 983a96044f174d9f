#!/usr/bin/env python3
"""Compares the documents with the source tree: fails if a link leads nowhere, if the table of folders in
docs/architecture.md differs from the rules in tests/architecture_test.cmake, if those rules have a cycle, also one
between folders of the top level, if a step of the walks there names a file or function that does not exist, if the table
of members in docs/reliability.md is not complete, or if a folder of the top level has no README, one that is too long, or
one that names a file that does not exist; or if CITATION.cff or the changelog lack the version, or if the table of the parameters of sensors in docs/sensors.md
differs from their lists of fields; or if the WebAssembly module lacks a source of the world service, or names one that is gone.

usage: check_docs.py ROOT [--write]     --write: corrects the column of dependencies in the table
"""
import pathlib
import re
import sys

WALKS = 6
FEWEST_STEPS = 4  # of a walk
MOST_README_LINES = 30


def rooms(root):
    """The folders of the top level that have sources."""
    return sorted(path for path in root.iterdir()
                  if path.is_dir() and path.name != "build" and not path.name.startswith("."))


def documents(root):
    return [*sorted(root.glob("*.md")), *sorted((root / "docs").glob("*.md")),
            *(room / "README.md" for room in rooms(root) if room.name != "docs" and (room / "README.md").exists())]


def check_room_readmes(root):
    problems = []
    for room in rooms(root):
        page = room / "README.md"
        if not page.exists():
            problems.append(f"{room.name}: expected a README.md")
            continue
        text = page.read_text()
        lines = text.count("\n")
        if lines > MOST_README_LINES:
            problems.append(f"{room.name}/README.md: found {lines} lines, expected at most {MOST_README_LINES}")
        for name in re.findall(r"`([\w/.-]+\.(?:h|cc|ts|py|cmake|json|md))`", text):
            places = [room / name, root / name, root / "include" / name, *room.glob(f"**/{name}")]
            if not any(place.exists() for place in places):
                problems.append(f"{room.name}/README.md: no file {name}")
    return problems


def check_links(root):
    """Problems of relative links; a fragment must be a heading of the page it leads to."""
    problems = []
    for page in documents(root):
        text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, fragment = target.partition("#")
            file = (page.parent / path).resolve() if path else page
            if not file.exists():
                problems.append(f"{page.relative_to(root)}: the link {target} leads to no file")
            elif fragment and fragment not in anchors(file):
                problems.append(f"{page.relative_to(root)}: the link {target} leads to no heading")
    return problems


def anchors(page):
    headings = re.findall(r"^#+ +(.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def rules(root):
    """By folder, in the order of the file: the folders that it may include."""
    text = re.sub(r"#[^\n]*", "", (root / "tests/architecture_test.cmake").read_text())
    return {folder: set(names.replace('"', "").split()) for folder, names in re.findall(r"set\(may_include_(\S+?)(?:\s+([^)]*))?\)", text)}


def reachable(folder, allowed):
    found = set()
    waiting = list(allowed.get(folder, ()))
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += allowed.get(name, ())
    return found


def direct(folder, allowed):
    """The dependencies of a folder without those that another of them has already."""
    names = allowed[folder]
    return sorted(name for name in names
                  if not any(name in reachable(other, allowed) for other in names if other != name))


def table_rows(text):
    """(line number, folder, contents, dependencies) of the table of folders."""
    rows = []
    for number, line in enumerate(text.split("\n")):
        match = re.match(r"\| `([^`]+)` \| (.*) \| (.*) \|$", line)
        if match and line.count(" | ") == 2:
            rows.append((number, *match.groups()))
    return rows


def check_table(root, write):
    allowed = rules(root)
    page = root / "docs/architecture.md"
    text = page.read_text()
    lines = text.split("\n")
    problems = []
    found = set()
    for number, folder, contents, dependencies in table_rows(text):
        found.add(folder)
        if folder not in allowed:
            problems.append(f"docs/architecture.md: no rule for the folder {folder} in tests/architecture_test.cmake")
            continue
        expected = ", ".join(direct(folder, allowed)) or "-"
        if dependencies != expected:
            problems.append(f"docs/architecture.md: {folder} depends on {expected}, found {dependencies}")
            lines[number] = f"| `{folder}` | {contents} | {expected} |"
    problems += [f"docs/architecture.md: the table of folders has no row for {folder}, "
                 f"expected | `{folder}` | ... | {', '.join(direct(folder, allowed)) or '-'} |"
                 for folder in allowed if folder not in found]
    problems += [f"tests/architecture_test.cmake: {folder} depends on itself"
                 for folder in allowed if folder in reachable(folder, allowed)]
    problems += room_cycles(allowed)
    if write:
        page.write_text("\n".join(lines))
    return problems


def room_cycles(allowed):
    """Folders of the top level that depend on each other. The public headers belong to `common`, as most of them do, but
    for that of `testing`."""
    def room(folder):
        if folder == "include/troupe/testing.h":
            return "testing"
        return "common" if folder.startswith("include/") else folder.split("/")[0]

    rooms = {}
    for folder, names in allowed.items():
        rooms.setdefault(room(folder), set()).update(room(name) for name in names if name in allowed)
    for name, others in rooms.items():
        others.discard(name)
    return [f"tests/architecture_test.cmake: {name} depends on {other}, and that on {name}"
            for name in rooms for other in sorted(rooms[name]) if name in reachable(other, rooms)]


def check_walks(root):
    """Each numbered step of a walk names a file and a function, as in: 1. `a/b.cc` `Class::Function`: ..."""
    text = (root / "docs/architecture.md").read_text()
    section = re.search(r"^## Walks through the code$(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    if section is None:
        return ["docs/architecture.md: expected a section 'Walks through the code'"]
    problems = []
    walks = re.split(r"^### ", section.group(1), flags=re.MULTILINE)[1:]
    if len(walks) != WALKS:
        problems.append(f"docs/architecture.md: found {len(walks)} walks, expected {WALKS}")
    for walk in walks:
        title = walk.split("\n", 1)[0]
        steps = re.findall(r"^\d+\. (.*)$", walk, re.MULTILINE)
        if len(steps) < FEWEST_STEPS:
            problems.append(f"docs/architecture.md: {title}: found {len(steps)} steps, expected at least {FEWEST_STEPS}")
        for step in steps:
            match = re.match(r"`([^`]+)` `([^`]+)`", step)
            if match is None:
                problems.append(f"docs/architecture.md: {title}: expected a file and a function in: {step}")
                continue
            file, function = match.groups()
            if not (root / file).is_file():
                problems.append(f"docs/architecture.md: {title}: no file {file}")
            elif not re.search(rf"(?<!\w){re.escape(function)}\(", (root / file).read_text()):
                problems.append(f"docs/architecture.md: {title}: no function {function} in {file}")
    return problems


def check_versions(root):
    """CITATION.cff, the changelog and the Python package know the version of CMakeLists.txt."""
    version = re.search(r"project\(troupe VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text()).group(1)
    expected = {"CITATION.cff": rf"^version: {re.escape(version)}$", "CHANGELOG.md": rf"^## {re.escape(version)}\b",
                "python/troupe/__init__.py": rf'^__version__ = "{re.escape(version)}"$'}
    return [f"{file}: expected the version {version}" for file, line in expected.items()
            if not re.search(line, (root / file).read_text(), re.MULTILINE)]


# The classes with the state of a run of the world service, and their files.
STATEFUL = {
    "RunProgress": "transport/protocol/run_progress.h",
    "LiveRun": "world-service/service/live_run.h",
    "Membership": "world-service/service/membership.h",
    "TickCoordinator": "world-service/service/tick_coordinator.h",
    "TickEngine": "world-service/service/tick_engine.h",
    "ProposalCollector": "world-service/service/tick_inputs.h",
    "RobotCommands": "world-service/service/tick_inputs.h",
    "WorldEditor": "world-service/service/world_editor.h",
    "RunControl": "world-service/service/run_control.h",
    "RobotMemories": "world-service/service/robot_memories.h",
    "RunStatistics": "world-service/service/tick_coordinator.h",
    "EventLog": "world-service/service/event_log.h",
    "NoticeList": "world-service/service/event_log.h",
    "Driver": "world-service/service/run_service.cc",
}


def members(text, name):
    """The data members of a class or struct, but for static ones and references."""
    body = re.search(rf"^(class|struct) {name}\b[^;{{]*{{\n(.*?)^}};", text, re.MULTILINE | re.DOTALL).group(2)
    found = re.findall(r"^  (?! |using|friend|static)([\w:<>,*& ]+) (\w+)(?: = [^;]*|{[^;]*})?;", body, re.MULTILINE)
    return [member for kind, member in found if not kind.endswith("&")]


def check_members(root):
    """Each member of the service's state has a row that says what another service has in its place."""
    page = root / "docs/reliability.md"
    section = re.search(r"^## State of the world service$(.*?)(?=^## |\Z)", page.read_text(), re.MULTILINE | re.DOTALL)
    if section is None:
        return ["docs/reliability.md: expected a section 'State of the world service'"]
    listed = re.findall(r"`(\w+::\w+)`", section.group(1))
    existing = [f"{name}::{member}" for name, file in STATEFUL.items() for member in members((root / file).read_text(), name)]
    return ([f"docs/reliability.md: {member} is listed {listed.count(member)} times" for member in sorted(set(listed))
             if listed.count(member) > 1] +
            [f"docs/reliability.md: there is no member {member}" for member in listed if member not in existing] +
            [f"docs/reliability.md: expected a row for {member}: is it saved, made anew or lost with the world service?"
             for member in existing if member not in listed])


def check_sensor_fields(root):
    """The table of sensors' parameters has the fields of include/troupe/sensor_description.h, in their order."""
    header = (root / "include/troupe/sensor_description.h").read_text()
    fields = {}
    for name, body in re.findall(r"^struct (\w+) \{\n(.*?)^\};", header, re.MULTILINE | re.DOTALL):
        listed = re.findall(r'Field\{"(\w+)", &(\w+)::(\w+)', body)
        fields[name] = [field for field, _, _ in listed]
        for part, element in (("ray_sensors", "RaySensorDescription"), ("segments", "BumperSegment")):
            if part in fields[name]:
                at = fields[name].index(part) + 1
                fields[name][at:at] = fields[element]
    types = dict(re.findall(r'^struct (\w+) \{\n  static constexpr std::string_view kType = "(\w+)";', header, re.MULTILINE))
    page = (root / "docs/sensors.md").read_text()
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", page[page.index("## A kind of your own"):page.index("## Cost")],
                           re.MULTILINE))
    problems = []
    for name, kind in types.items():
        if kind == "break_beam":
            continue
        expected = fields[name]
        found = re.findall(r"`(\w+)`", rows.get(kind, ""))
        if found != expected:
            problems.append(f"docs/sensors.md: fields of {kind}: found {found}, expected {expected}")
    return problems


def check_module_sources(root):
    """The module names sources of other folders, and is built where emscripten is: a new or moved source is found here."""
    named = set(re.findall(r"\$\{root\}/([\w/-]+\.cc)", (root / "viewer/module/CMakeLists.txt").read_text()))
    problems = [f"viewer/module/CMakeLists.txt: no file {name}" for name in sorted(named) if not (root / name).exists()]
    for source in sorted((root / "world-service/service").glob("*.cc")):
        # A run in a page has no threads.
        if source.name != "run_service.cc" and f"world-service/service/{source.name}" not in named:
            problems.append(f"viewer/module/CMakeLists.txt: expected world-service/service/{source.name}")
    return problems


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    root = pathlib.Path(sys.argv[1]).resolve()
    problems = check_links(root) + check_room_readmes(root) + check_table(root, "--write" in sys.argv) + check_walks(root)
    problems += check_versions(root)
    problems += check_members(root)
    problems += check_sensor_fields(root)
    problems += check_module_sources(root)
    for problem in problems:
        print(problem)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
