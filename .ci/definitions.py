"""Fails if a type, function or inline variable of namespace scope is defined in two files.

    definitions.py FILE ...           by their names in sources and headers, which ctags reads
    definitions.py --symbols a.a ...  by the symbols of static libraries, which know what a type is that has several names

The compiler finds two definitions in one source, and the linker two functions of objects that one program needs, but of
the rest the linker picks one without a word. Names of unnamed namespaces and static functions are of one source.
"""

import collections
import json
import re
import subprocess
import sys

BUILT_IN = {"auto", "bool", "char", "const", "double", "float", "int", "long", "short", "unsigned", "void"}


def parameter_type(parameter):
    """Of a parameter as written: without its name, its default, and const of a value."""
    parameter = re.sub(r"\s*=.*", "", parameter.strip())
    match = re.fullmatch(r"(.*[\w>&*.\]])\s+[&*]?(\w+)", parameter) or re.fullmatch(r"(.*[&*])\s*(\w+)", parameter)
    if match and match.group(2) not in BUILT_IN and match.group(1).strip() not in ("const", "struct"):
        parameter = parameter[:match.start(2)]
    parameter = re.sub(r"\s*([^\w\s])\s*", r"\1", parameter).strip()
    return parameter if re.search(r"[&*]$", parameter) else parameter.removeprefix("const ")


def signature(text):
    """The types of the parameters in "(int a,const std::map<int,int> & b={}) const", and what follows them."""
    types, depth, begin = [], 0, 1
    for end, letter in enumerate(text):
        depth += (letter in "(<[{") - (letter in ")>]}")
        if (letter == "," and depth == 1) or (letter == ")" and depth == 0):
            types.append(parameter_type(text[begin:end]))
            begin = end + 1
    return f"({', '.join(types)}){text[begin:]}"


def function(tag):
    """Its name, template parameters by their position, and signature."""
    text = f"{tag['name']}{signature(tag['signature'])}"
    template = tag.get("template", "<>").replace("class ", "typename ")
    for number, name in enumerate(re.findall(r"\b(\w+)\s*(?:=[^,]*)?[,>]", template)):
        text, template = (re.sub(rf"\b{name}\b", f"T{number}", part) for part in (text, template))
    return text + ("" if template == "<>" else f" with {template}")


def definitions(files):
    """(what, place) of each definition with a name of its own in the project."""
    options = ["--output-format=json", "--langmap=C++:.h.cc", "--languages=C++", "--kinds-C++=csugfv", "--fields=+Ssn",
               "--fields-C++=+{properties}{template}{specialization}"]
    output = subprocess.run(["ctags", *options, "-f", "-", "-L", "-"], input="\n".join(files), capture_output=True,
                            text=True, check=True).stdout
    for tag in map(json.loads, output.splitlines()):
        scope, kind, properties = tag.get("scope", ""), tag["kind"], tag.get("properties", "")
        if "__anon" in scope + tag["name"] or (scope == "" and tag["name"] == "main"):
            continue
        if kind == "function" and "static" in properties and tag.get("scopeKind", "namespace") == "namespace":
            continue
        if kind == "variable" and "inline" not in properties:
            continue
        name = function(tag) if kind == "function" else tag["name"] + tag.get("specialization", "")
        yield f"{scope}::{name}", f"{tag['path']}:{tag['line']}", tag["path"]


def symbols(archives):
    """(function or variable, archive) of each strong definition in static libraries."""
    for archive in archives:
        output = subprocess.run(["nm", "--defined-only", "--extern-only", "--demangle", archive], capture_output=True,
                                text=True, check=True).stdout
        for kind, name in re.findall(r"^[0-9a-f]+ ([TDBR]) (.*)$", output, re.M):
            yield name, archive, archive


def main():
    found = list(symbols(sys.argv[2:]) if sys.argv[1] == "--symbols" else definitions(sys.argv[1:]))
    places = collections.defaultdict(dict)  # by name: {file: place}
    for name, place, file in found:
        places[name][file] = place
    twice = {name: files for name, files in places.items() if len(files) > 1}
    for name, files in sorted(twice.items()):
        print(f"error: {name} is defined in\n  " + "\n  ".join(sorted(files.values())))
    if not twice and found:
        print(f"{len(places)} names, each defined once")
    sys.exit(1 if twice or not found else 0)


main()
