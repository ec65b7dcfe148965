#!/usr/bin/env python3
"""Static analysis of the core with clang-tidy (.clang-tidy), as many pieces at a time as there are cores.
The headers are checked through the sources that include them. clang-tidy walks through all that a source
includes, which takes most of its time: so the sources of a piece are checked together, as unity builds
compile them."""

import concurrent.futures
import json
import os
import subprocess
import sys

sys.dont_write_bytecode = True
from check_alone import BUILD, ROOT, options_of  # noqa: E402

# The analyser takes functions of included files for a header's, and leaves them out, unless the file
# that includes them has this name (AnalysisManager::isInCodeFile).
PIECE = "UnifiedSource"
# Analysed by itself: its noexcept functions call what throws for commands that were not checked. Theirs
# were, but where those bodies are in sight, that is reported.
ALONE = ROOT / "src" / "servo.cpp"


def analyse(piece, options):
    return subprocess.run(["clang-tidy", "--quiet", f"--config-file={ROOT / '.clang-tidy'}",
                           "--checks=-bugprone-suspicious-include", str(piece), "--", *options,
                           "-Wno-shadow"], capture_output=True, text=True, check=False)


def main():
    subprocess.run(["cmake", "--preset", "clang"], cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
    database = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
    core = {entry["file"]: options_of(entry["command"]) for entry in database
            if entry["file"].startswith(f"{ROOT}/src/")}
    if not core:
        sys.exit("analyse.py: no sources")
    options = core[str(ALONE)]
    sources = sorted(core.keys() - {str(ALONE)})
    jobs = os.cpu_count()
    pieces = []
    for number in range(min(jobs, len(sources))):
        pieces.append(BUILD / f"{PIECE}{number}.cpp")
        pieces[-1].write_text("".join(f'#include "{file}"\n' for file in sources[number::jobs]),
                              encoding="utf-8")
    pieces.append(ALONE)  # the shortest last
    bad = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for result in pool.map(lambda piece: analyse(piece, options), pieces):
            if result.returncode != 0:
                bad += 1
                print(result.stdout, result.stderr, flush=True)
    print(f"analyse: {len(core)} sources in {len(pieces)} pieces, {bad} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
