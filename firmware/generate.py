"""Writes what both sides of the protocol share: `python -m firmware.generate`, or `--check` to see whether it is so."""

from __future__ import annotations

import argparse
from pathlib import Path

from firmware import FOLDER, PROTOCOL
from firmware.definition import TYPES, UNCHECKED, Enum, Field, Message, Protocol, read_protocol
from puckpilot_env.files.whole_file import write_text_whole

PYTHON = FOLDER.parent / "sim2real" / "link" / "wire" / "messages.py"
WRITTEN = "Written by `python -m firmware.generate` from firmware/protocol.toml; do not edit."


def files(protocol: Protocol) -> dict[Path, str]:
    """Every generated file's text by its path."""
    core = FOLDER / "core"
    return {
        core / "include" / "messages.h": header(protocol),
        core / "messages.c": tables(protocol),
        PYTHON: python(protocol),
    }


def header(protocol: Protocol) -> str:
    """Structures, enums and the table's declaration."""
    longest = max(message.size for message in protocol.messages)
    lines = [
        f"/* {WRITTEN} */", "#ifndef MESSAGES_H", "#define MESSAGES_H", "", "#include <stdint.h>", "",
        f"#define PROTOCOL_MAJOR {protocol.version[0]}", f"#define PROTOCOL_MINOR {protocol.version[1]}",
        f"#define PROTOCOL_SCHEMA 0x{protocol.schema:08X}u",
        f"#define MESSAGE_UNCHECKED {UNCHECKED} /* its CRC begins at 0, that of others at the schema */",
        f"#define MESSAGE_LONGEST {longest} /* bytes of a body */", "",
    ]  # fmt: skip
    for enum in protocol.enums:
        lines += [f"/* {enum.doc} */", f"enum {enum.name} {{"]
        lines += [f"    {enum.name.upper()}_{name}, /* {doc} */" for name, doc in enum.values]
        lines += ["};", ""]
    lines += ["enum message {"]
    lines += [f"    MESSAGE_{one.name.upper()} = {one.id}, /* {one.doc} */" for one in protocol.messages]
    lines += ["};", ""]
    for message in protocol.messages:
        if message.fields:
            lines += [f"struct {message.name} {{", *map(_c_field, message.fields), "};", ""]
    lines += [
        "/* One number of a message, or several: where it is in the structure, and what it may be. */",
        "struct field {", "    uint8_t type; /* enum field_type */", "    uint8_t count;", "    uint16_t offset;",
        "    union limit {", "        float real;", "        uint32_t whole; /* of types without a sign */",
        "    } low, high;", "};", "",
        "enum field_type {", *(f"    FIELD_{name.upper()}," for name in TYPES), "};", "",
        "struct layout {", "    uint8_t id;", "    uint8_t fields; /* how many */",
        "    uint8_t size; /* bytes of the body */", "    const struct field *field;", "};", "",
        f"#define LAYOUTS {len(protocol.messages)}", "extern const struct layout layouts[LAYOUTS];", "", "#endif", "",
    ]  # fmt: skip
    return "\n".join(lines)


def _c_field(field: Field) -> str:
    many = f"[{field.count}]" if field.count > 1 else ""
    about = "; ".join(part for part in (field.unit, field.doc) if part)
    return f"    {TYPES[field.type][0]} {field.name}{many};" + (f" /* {about} */" if about else "")


def tables(protocol: Protocol) -> str:
    """What `wire.c` packs and unpacks by."""
    lines = [f"/* {WRITTEN} */", '#include "messages.h"', "", "#include <float.h>", "#include <stddef.h>", ""]
    for message in protocol.messages:
        if message.fields:
            lines += [f"static const struct field {message.name}_fields[] = {{"]
            lines += [_c_row(message, field) for field in message.fields]
            lines += ["};", ""]
    lines += ["const struct layout layouts[LAYOUTS] = {"]
    for message in protocol.messages:
        fields = f"{message.name}_fields" if message.fields else "NULL"
        lines += [f"    {{MESSAGE_{message.name.upper()}, {len(message.fields)}, {message.size}, {fields}}},"]
    return "\n".join([*lines, "};", ""])


def _c_row(message: Message, field: Field) -> str:
    at = f"offsetof(struct {message.name}, {field.name})"
    return f"    {{FIELD_{field.type.upper()}, {field.count}, {at}, {_c_limit(field, 0)}, {_c_limit(field, 1)}}},"


def _c_limit(field: Field, upper: int) -> str:
    """The limit, or what limits nothing but numbers that are none."""
    limit = (field.low, field.high)[upper]
    if field.type == "f32":
        return f"{{.real = {('-FLT_MAX', 'FLT_MAX')[upper] if limit is None else f'{float(limit)!r}f'}}}"
    return f"{{.whole = {('0', 'UINT32_MAX')[upper] if limit is None else f'{int(limit)}u'}}}"


def python(protocol: Protocol) -> str:
    """The same as dataclasses."""
    lines = [
        '"""Messages between host and microcontroller.', "", WRITTEN, '"""', "",
        "from __future__ import annotations", "", "from dataclasses import dataclass", "from enum import IntEnum", "",
        f"VERSION = {protocol.version!r}", f"SCHEMA = 0x{protocol.schema:08X}",
        f"UNCHECKED = {UNCHECKED}  # id of the message whose CRC begins at 0; that of the others at SCHEMA", "",
    ]  # fmt: skip
    for enum in protocol.enums:
        lines += ["", *_python_enum(enum), ""]
    for message in protocol.messages:
        lines += ["", *_python_class(message), ""]
    names = [f"    {_camel(message.name)}," for message in protocol.messages]
    lines += ["", "MESSAGES = (", *names, ")"]
    lines += ["FORMATS = {  # of a body, as Python's struct has it", *map(_format, protocol.messages), "}"]
    lines += ["LIMITS = {  # of the fields that have some", *_limits(protocol), "}", ""]
    return "\n".join(lines)


def _python_enum(enum: Enum) -> list[str]:
    values = [f"    {name} = {number}  # {doc}" for number, (name, doc) in enumerate(enum.values)]
    return [f"class {_camel(enum.name)}(IntEnum):", f'    """{enum.doc}"""', "", *values]


def _python_class(message: Message) -> list[str]:
    lines = ["@dataclass(frozen=True)", f"class {_camel(message.name)}:", f'    """{message.doc}"""', ""]
    for field in message.fields:
        kind = "float" if field.type == "f32" else "int"
        kind = f"tuple[{', '.join([kind] * field.count)}]" if field.count > 1 else kind
        about = "; ".join(part for part in (field.unit, field.doc) if part)
        lines += [f"    {field.name}: {kind}" + (f"  # {about}" if about else "")]
    return lines if message.fields else lines[:-1]


def _format(message: Message) -> str:
    codes = "".join(f"{field.count if field.count > 1 else ''}{TYPES[field.type][1]}" for field in message.fields)
    return f'    {_camel(message.name)}: ({message.id}, "<{codes}"),'


def _limits(protocol: Protocol) -> list[str]:
    rows = []
    for message in protocol.messages:
        limits = {field.name: (field.low, field.high) for field in message.fields if field.low is not None}
        if limits:
            rows += [f"    {_camel(message.name)}: {{"]
            rows += [f'        "{name}": ({low!r}, {high!r}),' for name, (low, high) in limits.items()]
            rows += ["    },"]
    return rows


def _camel(name: str) -> str:
    return name.title().replace("_", "")


def stale(protocol: Protocol) -> list[Path]:
    """Generated files that are not as they should be."""
    return [path for path, text in files(protocol).items() if not path.exists() or path.read_text() != text]


def write(protocol: Protocol) -> list[Path]:
    """Write the generated files that are not as they should be; which they were."""
    wrong = stale(protocol)
    for path in wrong:
        path.parent.mkdir(exist_ok=True)
        write_text_whole(path, files(protocol)[path])
    return wrong


def main() -> int:
    """0: written, or up to date; 1: asked to check, and something is stale."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help=f"only tell whether they follow from {PROTOCOL.name}")
    wrong = stale(protocol := read_protocol())
    if parser.parse_args().check:
        for path in wrong:
            print(f"{path} does not follow from {PROTOCOL.name}; run python -m firmware.generate")
        return 1 if wrong else 0
    for path in write(protocol):
        print(path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
