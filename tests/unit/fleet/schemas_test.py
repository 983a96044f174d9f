#!/usr/bin/python3
"""Holds our messages against the public JSON schemas of VDA 5050 (schemas/README.md).

usage: schemas_test.py FLEET_SEQUENCES SCHEMAS       SCHEMAS/VERSION has the schemas of a version

The validator knows the keywords that these schemas use, and refuses others. With --jsonschema the package of that name
judges, too.
"""
import json
import math
import pathlib
import re
import subprocess
import sys

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool}
IGNORED = {"$schema", "$id", "title", "description", "examples", "example", "definitions", "unit", "default", "format",
           "additionalProperties", "x-extensible-enum", "uniqueItems", "$comment", "subtopic"}
KNOWN = {"type", "required", "properties", "items", "enum", "const", "minimum", "maximum", "minItems", "pattern", "$ref",
         "allOf", "if", "then"}


def is_of_type(value, name):
    if isinstance(name, list):
        return any(is_of_type(value, each) for each in name)
    if name in ("number", "integer"):
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
        return is_number and (name == "number" or value == int(value))
    return isinstance(value, TYPES[name])


def faults(value, schema, root, path="$"):
    for keyword in schema:
        if keyword not in KNOWN and keyword not in IGNORED and not isinstance(schema[keyword], (str, dict)):
            raise ValueError(f"unknown keyword {keyword}")
    if "$ref" in schema:
        target = root
        for part in schema["$ref"].removeprefix("#/").split("/"):
            target = target[part]
        yield from faults(value, target, root, path)
    if "type" in schema and not is_of_type(value, schema["type"]):
        yield f"{path}: {value!r} is not of the type {schema['type']}"
        return
    if "enum" in schema and schema.get("type") != "array" and value not in schema["enum"]:
        yield f"{path}: {value!r} is none of {schema['enum']}"
    if "const" in schema and value != schema["const"]:
        yield f"{path}: {value!r} is not {schema['const']}"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        if value < schema.get("minimum", -math.inf) or value > schema.get("maximum", math.inf):
            yield f"{path}: {value} is out of range"
    if isinstance(value, str) and "pattern" in schema and not re.search(schema["pattern"], value):
        yield f"{path}: {value!r} does not match {schema['pattern']}"
    if isinstance(value, list):
        if len(value) < schema.get("minItems", 0):
            yield f"{path}: {len(value)} items"
        for i, item in enumerate(value):
            yield from faults(item, schema.get("items", {}), root, f"{path}[{i}]")
    if isinstance(value, dict):
        for name in schema.get("required", []):
            if name not in value:
                yield f"{path}: no {name}"
        for name, member in schema.get("properties", {}).items():
            if name in value:
                yield from faults(value[name], member, root, f"{path}.{name}")
    for each in schema.get("allOf", []):
        yield from faults(value, each, root, path)
    if "if" in schema and not any(faults(value, schema["if"], root, path)):
        yield from faults(value, schema.get("then", {}), root, path)


# Where the text has what the schema lacks, the text holds (section 6 of 2.1).
TEXT_HOLDS = re.compile(r"actionStatus: 'PAUSED' is|actions\[\d+\]: (no actionName|'actionName' is a required)")


def main():
    program, schemas = sys.argv[1], pathlib.Path(sys.argv[2])
    messages = subprocess.run([program, "--messages", "0", "90"], capture_output=True, text=True, check=True).stdout
    count, wrong, topics, validators = 0, 0, set(), {}
    for line in messages.splitlines():
        topic, version, text = line.split(" ", 2)
        path = schemas / version / f"{topic}.schema"
        if path not in validators:
            validators[path] = json.loads(path.read_text())
        count += 1
        topics.add((topic, version))
        schema = validators[path]
        found = list(faults(json.loads(text), schema, schema))
        if "--jsonschema" in sys.argv:
            import jsonschema
            validator = jsonschema.validators.validator_for(schema)(schema)
            found += [f"{error.json_path}: {error.message}" for error in validator.iter_errors(json.loads(text))]
        for fault in found:
            if TEXT_HOLDS.search(fault):
                continue
            wrong += 1
            print(f"{topic} {version}: {fault[:300]}")
    # A validator that finds nothing would pass everything.
    order = json.loads((schemas / "2.1" / "order.schema").read_text())
    if not list(faults({"orderId": 7}, order, order)):
        print("the validator finds no fault in a wrong order")
        wrong += 1
    print(f"{count} messages of {len(topics)} kinds, {wrong} faults")
    sys.exit(1 if wrong or len(topics) < 20 else 0)


main()
