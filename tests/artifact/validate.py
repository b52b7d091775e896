"""Validates artifacts by libraries that others wrote: RO-Crate by rocrate, CITATION.cff by cffconvert.

Usage: validate.py FOLDER...

Leaves out a library that is not installed, and says so.
"""

import hashlib
import importlib
import sys
from pathlib import Path


def library(name):
    """Returns a library, or None if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"{name.split('.')[0]} is not installed: not validated by it")
        return None


def crate(folder, rocrate):
    """Reads the crate; every file is known with its checksum, and the root with what the specification requires."""
    read = rocrate.ROCrate(folder)
    root = read.root_dataset
    for key in ["name", "description", "datePublished", "license", "author"]:
        assert root.get(key), f"{folder}: the root has no {key}"
    files = {str(entity.id): entity for entity in read.data_entities if entity.type == "File"}
    assert files, f"{folder}: no file"
    for name, entity in files.items():
        path = Path(folder, entity.get("name"))
        data = path.read_bytes()
        assert entity.get("contentSize") == str(len(data)), f"{name}: size"
        assert entity.get("sha256") == hashlib.sha256(data).hexdigest(), f"{name}: checksum"
        assert entity.get("encodingFormat"), f"{name}: no media type"
    there = {path for path in Path(folder).rglob("*") if path.is_file()}
    listed = {Path(folder, entity.get("name")) for entity in files.values()}
    assert there - listed == {Path(folder, "ro-crate-metadata.json")}, f"{folder}: {there - listed} are not listed"
    print(f"{folder}: rocrate reads a crate of {len(files)} files")


def citation(folder, cffconvert):
    """Validates against the schema of the Citation File Format, and converts to BibTeX."""
    text = Path(folder, "CITATION.cff").read_text(encoding="utf-8")
    read = cffconvert.Citation(text)
    read.validate()
    assert read.as_bibtex().startswith("@")
    print(f"{folder}: cffconvert finds a valid citation")


def main(folders):
    """Validates each folder."""
    rocrate, cffconvert = library("rocrate.rocrate"), library("cffconvert")
    for folder in folders:
        if rocrate:
            crate(folder, rocrate)
        if cffconvert:
            citation(folder, cffconvert)


main(sys.argv[1:])
