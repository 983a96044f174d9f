#!/usr/bin/env python3
"""Checks that the ROS messages of idl/ros have the fields of ROS 2 Jazzy, by name, type and order.

Computes the type hash of each message (REP 2011, RIHS01) from our IDL, and compares it with that of Jazzy. The hash
covers all nested messages, so equal hashes mean equal layouts.
    check_type_hashes.py <idl/ros> <ros-type-hashes-jazzy.json>
"""
import hashlib
import json
import pathlib
import re
import sys

TYPE_IDS = {"int8": 2, "uint8": 3, "octet": 3, "short": 4, "unsigned short": 5, "long": 6, "unsigned long": 7,
            "long long": 8, "unsigned long long": 9, "float": 10, "double": 11, "boolean": 15, "string": 17}
NESTED, BYTE, BOUNDED_STRING = 1, 16, 21
ARRAY, BOUNDED_SEQUENCE, SEQUENCE = 48, 96, 144
# ROS has a type of its own for bytes.
BYTE_FIELDS = {("rcl_interfaces/msg/ParameterValue", "byte_array_value")}
# The fields that precede the ROS message on the wire.
SERVICE_HEADER = ["client_guid", "sequence_number"]


def read_messages(paths):
    """Fields (IDL type, name, array size) by ROS type name."""
    messages = {}
    for path in sorted(paths):
        text = re.sub(r"//[^\n]*|#[^\n]*", "", path.read_text())
        for package, kind, body in re.findall(
                r"module (\w+) \{ module (\w+) \{ module dds_ \{(.*?)\n\}; \}; \};", text, re.S):
            for name, fields in re.findall(r"struct (\w+)_ \{(.*?)\};", body, re.S):
                parsed = []
                for field in filter(None, (part.strip() for part in fields.split(";"))):
                    type_, field_name, _, size = re.fullmatch(r"(.+?)\s+(\w+)(\[(\d+)\])?", field, re.S).groups()
                    parsed.append((" ".join(type_.split()), field_name, int(size or 0)))
                if kind == "srv" or kind == "action" and name.endswith(("_Request", "_Response")):
                    assert [field[1] for field in parsed[:2]] == SERVICE_HEADER, name
                    parsed = parsed[2:]
                messages[f"{package}/{kind}/{name}"] = parsed
    return messages


def describe_type(idl_type, package, message, field):
    """Type id and the rest of a field's type."""
    if sequence := re.fullmatch(r"sequence<(.+?)(?:,\s*(\d+))?>", idl_type):
        element = describe_type(sequence[1], package, message, field)
        bound = int(sequence[2] or 0)
        return {**element, "type_id": element["type_id"] + (BOUNDED_SEQUENCE if bound else SEQUENCE), "capacity": bound}
    result = {"type_id": 0, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}
    if bounded := re.fullmatch(r"string<(\d+)>", idl_type):
        return {**result, "type_id": BOUNDED_STRING, "string_capacity": int(bounded[1])}
    if idl_type in TYPE_IDS:
        return {**result, "type_id": BYTE if (message, field) in BYTE_FIELDS else TYPE_IDS[idl_type]}
    parts = idl_type.split("::")
    name = f"{parts[0]}/{parts[1]}/{parts[-1][:-1]}" if len(parts) > 1 else f"{package}/msg/{idl_type[:-1]}"
    return {**result, "type_id": NESTED, "nested_type_name": name}


def describe(name, messages):
    package = name.split("/")[0]
    fields = []
    for idl_type, field, size in messages[name]:
        type_ = describe_type(idl_type, package, name, field)
        if size:
            type_ = {**type_, "type_id": type_["type_id"] + ARRAY, "capacity": size}
        fields.append({"name": field, "type": type_})
    return {"type_name": name, "fields": fields}


def nested_in(name, messages, found):
    for field in describe(name, messages)["fields"]:
        nested = field["type"]["nested_type_name"]
        if nested and nested not in found:
            found.add(nested)
            nested_in(nested, messages, found)
    return found


def type_hash(name, messages):
    document = {"type_description": describe(name, messages),
                "referenced_type_descriptions": [describe(n, messages) for n in sorted(nested_in(name, messages, set()))]}
    text = json.dumps(document, ensure_ascii=True, separators=(", ", ": "), sort_keys=False)
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


def descriptions(messages):
    """A line for each type: its name, and "name:type:capacity:string capacity:nested type" for each of its fields."""
    lines = []
    for name in sorted(messages):
        fields = []
        for field in describe(name, messages)["fields"]:
            type_ = field["type"]
            fields.append(f"{field['name']}:{type_['type_id']}:{type_['capacity']}:{type_['string_capacity']}:"
                          f"{type_['nested_type_name']}")
        lines.append(" ".join([name] + fields) + "\n")
    return "".join(lines)


def main():
    files = set(pathlib.Path(sys.argv[1]).glob("*.idl"))
    others = {path for path in files if path.stem in ("humble", "kilted", "rolling")}
    messages = read_messages(files - others)
    # Those whose layout is another one from Kilted on; the types that they name are of Kilted where there are both.
    kilted = read_messages(path for path in others if path.stem == "kilted")
    later = {**messages, **{name: [(field[0].replace("::kilted::", "").replace("::rmf_", "rmf_"), *field[1:])
                                   for field in fields] for name, fields in kilted.items()}}
    path = pathlib.Path(sys.argv[3])
    if "--write" in sys.argv:
        path.write_text(descriptions(messages))
    known = json.loads(pathlib.Path(sys.argv[2]).read_text())
    wrong = [name for name in messages if type_hash(name, messages) != known.get(name)]
    wrong += [name for name in kilted if type_hash(name, later) != known.get("kilted/" + name)]
    for name in wrong:
        print(f"error: {name}: found the hash {type_hash(name, messages)}, expected {known.get(name)}", file=sys.stderr)
    print(f"{len(messages) - len(wrong)} of {len(messages)} messages are as in ROS 2 Jazzy")
    if path.read_text() != descriptions(messages):
        print(f"error: {path} differs from the IDL: run this with --write", file=sys.stderr)
        return 1
    return 1 if wrong or len(messages) < 40 else 0


if __name__ == "__main__":
    sys.exit(main())
