#!/usr/bin/env python3
"""Fetch the packages named in a package-lock.json and check their hashes: `npm ci` without npm. Usage: fetch_npm.py FOLDER

Works only for packages without install scripts. A mirror of the registry: npm_config_registry=https://...
"""
import base64
import hashlib
import io
import json
import os
import shutil
import sys
import tarfile
import urllib.request
from pathlib import Path

REGISTRY = "https://registry.npmjs.org/"
folder = Path(sys.argv[1])
lock = json.loads((folder / "package-lock.json").read_text())
for place, package in lock["packages"].items():
    if not place:
        continue  # the folder itself
    target = folder / place
    done = target / "package.json"
    if done.exists() and json.loads(done.read_text())["version"] == package["version"]:
        continue
    url = package["resolved"].replace(REGISTRY, os.environ.get("npm_config_registry", REGISTRY).rstrip("/") + "/")
    try:
        archive = urllib.request.urlopen(url, timeout=60).read()
    except OSError as error:
        sys.exit(f"fetch_npm: {url}: {error}")
    kind, wanted = package["integrity"].split("-", 1)
    if base64.b64encode(hashlib.new(kind, archive).digest()).decode() != wanted:
        sys.exit(f"fetch_npm: {url}: is not what package-lock.json says ({kind})")
    fresh = target.with_name(target.name + ".new")
    shutil.rmtree(fresh, ignore_errors=True)
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        for member in tar.getmembers():
            path = Path(*Path(member.name).parts[1:])  # all files are in one folder, "package"
            if member.isfile() and ".." not in path.parts:
                (fresh / path).parent.mkdir(parents=True, exist_ok=True)
                (fresh / path).write_bytes(tar.extractfile(member).read())
    shutil.rmtree(target, ignore_errors=True)
    fresh.rename(target)
    print(f"fetch_npm: {place} {package['version']}")
