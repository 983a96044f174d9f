"""Builds a wheel of the package troupe by CMake, with libtroupe in it: the backend of pyproject.toml (PEP 517).

It needs no package of Python but those that are there, so that `pip install .` works without a network.
"""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def _version():
    return re.search(r"project\(troupe VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


def _metadata():
    return (f"Metadata-Version: 2.1\nName: troupe\nVersion: {_version()}\n"
            "Summary: A deterministic 2.5D simulator of many mobile robots\nLicense: Apache-2.0\n"
            "Requires-Python: >=3.9\nRequires-Dist: numpy\nDescription-Content-Type: text/markdown\n\n"
            + (ROOT / "docs/python.md").read_text())


# Of every system with the C library of the wheel's tag and with the standard library of C++.
_OF_THE_SYSTEM = ("ld-linux", "libc.so", "libm.so", "libgcc_s.so", "libstdc++.so", "libpthread.so", "libdl.so", "librt.so")


def _needed_libraries(library):
    """The shared libraries that `library` needs, directly or through others, beside the system's: paths by name."""
    found = subprocess.run(["ldd", str(library)], check=True, text=True, stdout=subprocess.PIPE).stdout
    places = re.findall(r"^\s*(\S+) => (/\S+)", found, flags=re.MULTILINE)
    return {name: pathlib.Path(place) for name, place in places if not name.startswith((*_OF_THE_SYSTEM, "libtroupe"))}


def _copyrights(libraries):
    """The terms of the packages of Debian that the libraries are of, by the names of the packages."""
    texts = {}
    for place in libraries:
        owner = subprocess.run(["dpkg-query", "--search", f"*/{place.resolve().name}"], check=False, text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL).stdout.split(":")[0]
        text = pathlib.Path(f"/usr/share/doc/{owner}/copyright")
        if owner and text.exists():
            texts[owner] = text.read_bytes()
    return texts


def _changed(data, *command):
    """A shared library after a command that changes the file."""
    with tempfile.NamedTemporaryFile(suffix=".so") as file:
        file.write(data)
        file.flush()
        subprocess.run([*command, file.name], check=True)
        return pathlib.Path(file.name).read_bytes()


def _build(folder):
    """Compiles the package into `folder`/python/troupe."""
    configure = ["cmake", "-S", str(ROOT), "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON",
                 "-DTROUPE_TESTS=OFF", "-DTROUPE_WEB_PAGE=OFF", f"-DPython_EXECUTABLE={sys.executable}"]
    subprocess.run(configure + (["-G", "Ninja"] if _has("ninja") else []), check=True)
    subprocess.run(["cmake", "--build", folder, "--parallel", str(os.cpu_count() or 1), "--target", "python_package"],
                   check=True)


def _has(program):
    return any(os.access(os.path.join(place, program), os.X_OK) for place in os.environ["PATH"].split(":"))


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Settings: `built`, a build folder that has the package already; `bundle`, with all libraries that a bare system lacks."""
    settings = config_settings or {}
    tag = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    if settings.get("bundle"):
        platform = platform.replace("linux", f"manylinux_{os.confstr('CS_GNU_LIBC_VERSION').split()[1].replace('.', '_')}")
    info = f"troupe-{_version()}.dist-info"
    name = f"troupe-{_version()}-{tag}-{tag}-{platform}.whl"
    with tempfile.TemporaryDirectory() as temporary:
        folder = settings.get("built", temporary)
        if folder == temporary:
            _build(folder)
        package = pathlib.Path(folder) / "python/troupe"
        if not list(package.glob(f"_troupe*{tag[2:]}*.so")):
            raise RuntimeError("the package was not built: see CMake's message above, and run scripts/setup")
        # The wheel has no links: the library has the name by which the extension knows it.
        library = next(path for path in (pathlib.Path(folder) / "lib").glob("libtroupe.so.*.*") if path.is_symlink())
        content = {f"troupe/{path.relative_to(package)}": path.read_bytes()
                   for path in sorted(package.rglob("*")) if path.is_file() and "__pycache__" not in path.parts}
        content[f"troupe/{library.name}"] = library.read_bytes()
        if settings.get("bundle"):
            # The search path of the extension is that of libraries that have none of their own.
            needed = _needed_libraries(library)
            content.update({f"troupe/{name}": _changed(place.read_bytes(), "patchelf", "--remove-rpath") for name, place in sorted(needed.items())})
            content.update({f"{info}/licenses/{owner}": text for owner, text in sorted(_copyrights(needed.values()).items())})
            content.update({path: _changed(data, "strip", "--strip-unneeded") for path, data in content.items() if ".so" in path})
    for part in ("office.world", "robotics_lab.world", "include", "bitmaps", "scenarios"):
        place = ROOT / "worlds" / part
        for path in sorted(place.rglob("*")) if place.is_dir() else [place]:
            if path.is_file():
                content[f"troupe/worlds/{path.relative_to(ROOT / 'worlds')}"] = path.read_bytes()
    content[f"{info}/METADATA"] = _metadata().encode()
    content[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: troupe\nRoot-Is-Purelib: false\n"
                                f"Tag: {tag}-{tag}-{platform}\n").encode()
    content[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    content[f"{info}/entry_points.txt"] = b"[pytest11]\ntroupe = troupe.pytest_plugin\n"
    # Each file with its digest, as the format of wheels (PEP 427) demands; RECORD itself has none.
    record = "".join(f"{path},sha256={_digest(data)},{len(data)}\n" for path, data in content.items())
    content[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    # Of the release, so that the same files give the same bytes.
    stamp = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())), 315532800))[:6]
    with zipfile.ZipFile(os.path.join(wheel_directory, name), "w") as wheel:
        for path, data in content.items():
            entry = zipfile.ZipInfo(path, stamp)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            wheel.writestr(entry, data)
    return name


def _digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def build_sdist(sdist_directory, config_settings=None):
    name = f"troupe-{_version()}"
    archive = os.path.join(sdist_directory, name + ".tar.gz")
    subprocess.run(["git", "-C", str(ROOT), "archive", "--format=tar.gz", f"--prefix={name}/", "-o", archive, "HEAD"],
                   check=True)
    return os.path.basename(archive)
