"""Type hashes of ROS 2 (REP-2011, RIHS01) out of an IDL file: "pkg/msg/Name RIHS01_..." on each line.

A type hash is the SHA-256 of the type description as JSON, with the descriptions of all types in it, by name.
Numbers of the field types: type_description_interfaces/msg/FieldType.
"""
import hashlib
import json
import re
import sys

PRIMITIVES = {"octet": 3, "long": 6, "unsigned long": 7, "unsigned long long": 9, "double": 11, "boolean": 15, "string": 17}
NESTED, ARRAY, SEQUENCE = 1, 48, 144
# IDL has one word for ROS's uint8 and byte; these are bytes.
BYTES, BYTE = {"diagnostic_msgs/msg/DiagnosticStatus.level"}, 16


def field_of(declaration, owner):
    kind, name, capacity = re.fullmatch(r"(.+?)\s+(\w+)(?:\[(\d+)\])?", declaration.strip()).groups()
    sequence = re.fullmatch(r"sequence<(.+)>", kind)
    element = sequence[1] if sequence else kind
    type_id = BYTE if f"{owner}.{name}" in BYTES else PRIMITIVES.get(element, NESTED)
    nested = "" if element in PRIMITIVES else ros_name(element.split("::"))
    type_id += SEQUENCE if sequence else ARRAY if capacity else 0
    return {"name": name, "type": {"type_id": type_id, "capacity": int(capacity or 0), "string_capacity": 0,
                                   "nested_type_name": nested}}


def ros_name(parts):
    package, kind, mangled, name = parts
    assert (kind, mangled, name[-1]) == ("msg", "dds_", "_"), parts
    return f"{package}/{kind}/{name[:-1]}"


def types_of(idl):
    idl = re.sub(r"//[^\n]*", "", idl)
    types = {}
    for package, body in re.findall(r"module (\w+) \{ module msg \{ module dds_ \{(.*?)\}; \}; \};", idl, re.S):
        for name, fields in re.findall(r"@final struct (\w+) \{(.*?)\};", body, re.S):
            owner = ros_name([package, "msg", "dds_", name])
            types[owner] = [field_of(f, owner) for f in fields.split(";") if f.strip()]
    return types


def nested_in(types, name):
    found = set()
    for field in types[name]:
        if inner := field["type"]["nested_type_name"]:
            found |= {inner} | nested_in(types, inner)
    return found


def hash_of(types, name):
    describe = lambda n: {"type_name": n, "fields": types[n]}
    description = {"type_description": describe(name),
                   "referenced_type_descriptions": [describe(n) for n in sorted(nested_in(types, name))]}
    return "RIHS01_" + hashlib.sha256(json.dumps(description).encode()).hexdigest()


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        found = types_of(file.read())
    for type_name in found:
        print(type_name, hash_of(found, type_name))
