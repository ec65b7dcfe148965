#!/usr/bin/env python3
"""Checks the Debian packages without installing them. lintian finds no error, the files that users and other
programs look for are there, and a dependency provides each library that the static libraries need.
scripts/deep/packages installs them."""

import pathlib
import re
import subprocess
import sys
import tempfile

PACKAGES = {"palpate", "palpate-io-helper", "libpalpate-c0", "libpalpate-dev"}
FILES = """usr/bin/palpate usr/bin/palpate-viewer usr/libexec/palpate/palpate-io-helper
    usr/libexec/palpate/palpate-io-dicom usr/libexec/palpate/palpate-io-images
    usr/libexec/palpate/palpate-io-itk usr/libexec/palpate/palpate-io-vtk
    usr/libexec/palpate/palpate-explicit-helper usr/libexec/palpate/palpate-picture-helper
    usr/share/palpate/visible_human_head.nrrd usr/share/palpate/layers/sample-head.json
    usr/share/man/man1/palpate.1.gz usr/share/man/man1/palpate-viewer.1.gz
    usr/share/bash-completion/completions/palpate usr/share/applications/palpate.desktop
    usr/share/mime/packages/palpate.xml usr/share/metainfo/palpate.metainfo.xml
    usr/share/icons/hicolor/scalable/apps/palpate.svg usr/lib/udev/rules.d/70-palpate.rules
    etc/security/limits.d/palpate.conf usr/include/palpate.h usr/include/palpate/palpate.hpp
    usr/share/doc/palpate/copyright usr/share/doc/libpalpate-c0/changelog.Debian.gz""".split()


def run(*words):
    done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode}: {' '.join(map(str, words))}\n{done.stdout}")
    return done.stdout


def field(package, name):
    return run("dpkg-deb", "-f", package, name).strip()


def check_what_is_linked(root, package):
    """The static libraries need others: each comes with a package that theirs depends on."""
    text = "".join(p.read_text() for p in root.rglob("palpate-*-targets.cmake"))
    linked = set()
    for listed in re.findall(r'INTERFACE_LINK_LIBRARIES "([^"]*)"', text):
        linked |= set(re.sub(r"\\\$<LINK_ONLY:([^>]*)>", r"\1", listed).split(";"))
    names = {"CURL::libcurl": "curl", "ZLIB::ZLIB": "z"}
    of_system = {"", "dl", "Threads::Threads", "Eigen3::Eigen"}  # Eigen is headers alone
    needed = {names.get(one, one) for one in linked - of_system if not one.startswith("palpate::")}
    if not {"curl", "zstd"} <= needed:
        sys.exit(f"what the libraries are linked with was not found: {sorted(linked)}")
    depends = {re.split("[ (:]", one.strip())[0] for one in field(package, "Depends").split(",")}
    for one in sorted(needed):
        owner = run("dpkg", "-S", f"*/lib{one}.so").split(":")[0]
        if owner not in depends:
            sys.exit(f"{package.name} needs lib{one}, but does not depend on {owner}")


def main():
    packages = {field(path, "Package"): path for path in sorted(pathlib.Path(sys.argv[1]).glob("*.deb"))}
    if not PACKAGES <= set(packages):
        sys.exit(f"made {sorted(packages)}, expected {sorted(PACKAGES)}")
    print(run("lintian", "--allow-root", "--fail-on", "error", *packages.values()))
    with tempfile.TemporaryDirectory(prefix="palpate-packages-") as name:
        root = pathlib.Path(name)
        for path in packages.values():
            run("dpkg-deb", "-x", path, root)
        missing = [file for file in FILES if not (root / file).exists()]
        if missing:
            sys.exit(f"not in the packages: {missing}")
        check_what_is_linked(root, packages["libpalpate-dev"])


main()
