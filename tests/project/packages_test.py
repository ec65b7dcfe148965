#!/usr/bin/env python3
"""The Debian packages, made from a build folder that exists: what lintian says, and installing,
using, upgrading and removing them in a scratch root. Scripts of packages do nothing there; the
libraries of other packages are those of this system."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE, BUILD, CC = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
VERSION = re.search(r"^project\(palpate VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text(),
                    re.MULTILINE).group(1)
PACKAGES = {"palpate", "palpate-io-helper", "libpalpate-c0", "libpalpate-dev"}
FILES = """usr/bin/palpate usr/bin/palpate-viewer usr/libexec/palpate/palpate-io-helper
    usr/libexec/palpate/palpate-io-dicom usr/libexec/palpate/palpate-io-images
    usr/libexec/palpate/palpate-io-itk usr/libexec/palpate/palpate-io-vtk
    usr/libexec/palpate/palpate-evaluate usr/libexec/palpate/palpate-picture-helper
    usr/share/palpate/visible_human_head.nrrd usr/share/palpate/layers/sample-head.json
    usr/share/man/man1/palpate.1.gz usr/share/man/man1/palpate-viewer.1.gz
    usr/share/bash-completion/completions/palpate usr/share/applications/palpate.desktop
    usr/share/mime/packages/palpate.xml usr/share/metainfo/palpate.metainfo.xml
    usr/share/icons/hicolor/scalable/apps/palpate.svg usr/lib/udev/rules.d/70-palpate.rules
    etc/security/limits.d/palpate.conf usr/include/palpate.h usr/include/palpate/palpate.hpp
    usr/share/doc/palpate/copyright usr/share/doc/libpalpate-c0/changelog.Debian.gz""".split()


def run(*words, **options):
    done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode}: {' '.join(map(str, words))}\n{done.stdout}")
    return done.stdout


def field(package, name):
    return run("dpkg-deb", "-f", package, name).strip()


class Root:
    """A scratch root with a package database of its own."""

    def __init__(self, path):
        self.path = path
        for folder in ("info", "updates", "triggers", "alternatives"):
            (path / "var/lib/dpkg" / folder).mkdir(parents=True)
        for name in ("status", "available"):
            (path / "var/lib/dpkg" / name).touch()

    def dpkg(self, *words):
        return run("dpkg", f"--root={self.path}", "--force-depends", "--force-not-root",
                   "--force-script-chrootless", "--log=/dev/null", *words)

    def installed(self):
        lines = run("dpkg-query", f"--admindir={self.path}/var/lib/dpkg", "-W",
                    "-f=${Package} ${Version} ${db:Status-Status}\\n").splitlines()
        return {line.split()[0]: line.split()[1] for line in lines if line.endswith(" installed")}

    def files(self):
        return sorted(str(p.relative_to(self.path)) for p in self.path.rglob("*")
                      if (p.is_file() or p.is_symlink()) and "var/lib/dpkg" not in str(p))


def later(package, folder):
    """The same package with a later version."""
    tree = folder / package.stem
    run("dpkg-deb", "-R", package, tree)
    control = tree / "DEBIAN/control"
    control.write_text(control.read_text().replace(f"{VERSION}-1", f"{VERSION}-2"))
    made = folder / package.name.replace("-1_", "-2_")
    run("dpkg-deb", "--root-owner-group", "-Znone", "-b", tree, made)
    return made


def use(root, folder):
    """The program and the C library as they lie in the scratch root."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("PALPATE", "DISPLAY"))}
    report = run(root / "usr/bin/palpate", "demo", "--quiet", "--output", folder / "demo",
                 env=clean, cwd=folder)
    if not list((folder / "demo").glob("*.png")):
        sys.exit(f"the demo left no picture: {report}")
    libraries = next(root.glob("usr/lib/**/libpalpate-c.so.0")).parent
    clean["PKG_CONFIG_PATH"] = str(libraries / "pkgconfig")
    flags = run("pkg-config", "--cflags", "--libs", "palpate-c", env=clean).split()
    run(CC, SOURCE / "tests/project/installed.c", "-o", folder / "own", *flags)
    said = run(folder / "own", root / "usr/share/palpate/visible_human_head.nrrd",
               env=clean | {"LD_LIBRARY_PATH": str(libraries)})
    if not said.startswith("96 samples along x"):
        sys.exit(f"the C program said: {said}")


def check_what_is_linked(root, package):
    """The static libraries need others: each comes with a package that theirs depends on."""
    text = "".join(p.read_text() for p in root.rglob("palpate-*-targets.cmake"))
    linked = set()
    for listed in re.findall(r'INTERFACE_LINK_LIBRARIES "([^"]*)"', text):
        linked |= set(re.sub(r"\\\$<LINK_ONLY:([^>]*)>", r"\1", listed).split(";"))
    names = {"CURL::libcurl": "curl", "TBB::tbb": "tbb", "ZLIB::ZLIB": "z"}
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
    with tempfile.TemporaryDirectory(prefix="palpate-packages-") as name:
        scratch = pathlib.Path(name)
        scratch.chmod(0o755)  # dpkg unpacks below it
        out = scratch / "out"
        run(SOURCE / "scripts/package.sh", "--build", BUILD, out)
        made = sorted(out.glob("*.deb"))
        names = {field(p, "Package") for p in made}
        if not PACKAGES <= names:
            sys.exit(f"made {sorted(names)}, expected {sorted(PACKAGES)}")
        print(run("lintian", "--allow-root", "--fail-on", "error", *made))
        root = Root(scratch / "root")
        root.dpkg("-i", *made)
        missing = set(FILES) - set(root.files())
        if missing:
            sys.exit(f"not installed: {sorted(missing)}")
        check_what_is_linked(root.path, next(p for p in made if p.name.startswith("libpalpate-dev_")))
        use(root.path, scratch)
        root.dpkg("-i", *(later(p, scratch) for p in made))
        if set(root.installed().values()) != {f"{VERSION}-2"}:
            sys.exit(f"after the upgrade: {root.installed()}")
        root.dpkg("-r", *names)
        if root.files() != ["etc/security/limits.d/palpate.conf"]:
            sys.exit(f"left by removing: {root.files()}")
        root.dpkg("-P", *names)
        if root.files() or root.installed():
            sys.exit(f"left by purging: {root.files()}")
        print(f"{len(made)} packages: installed, used, upgraded, removed")


main()
