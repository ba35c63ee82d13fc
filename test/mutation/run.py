#!/usr/bin/env python3
"""Do the tests see it when a line is wrong? Draws mutants (mutants.py) of estimators, protocol and
transport by a seed, builds each in a working tree of its own, and runs the unit and pipeline tests
that it is linked into, those of its own folder first, until one fails. What was tried is kept in
OUT/results.jsonl: the same command goes on where it was ended. Ends with a table and with the mutants
that no test has killed.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path

import mutants

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = [
    *("robot/" + name for name in "cloud_client fusion inertial odometry submap tracking uplink vio".split()),
    *("cloud/" + name for name in "localizer locate pool".split()),
    *("shared/" + name for name in "coding compact factors geometry protocol transport wire".split()),
]
LABELS = ("unit", "pipeline")
HANGS_AFTER_S = 900


class Build:
    """A working tree, and the test programs in it."""

    def __init__(self, out):
        self.tree = out / "tree"
        self.programs = {}  # name: seconds that it takes
        if not self.tree.exists():
            run("git", "worktree", "prune", cwd=ROOT)
            run("git", "worktree", "add", "--detach", self.tree, "HEAD", cwd=ROOT)
        self.revert()

    def revert(self):
        run("git", "checkout", "--quiet", ".", cwd=self.tree)

    def targets(self):
        """The folder of each test program, by its name."""
        folders = {}
        for file in (self.tree / "test").rglob("CMakeLists.txt"):
            for name, label in re.findall(r"fleetloc_test\((\w+)[^)]*?LABEL (\w+)", file.read_text()):
                if label in LABELS and not name.startswith("fuzz"):
                    folders[name] = file.parent.name
        return folders

    def make(self, names):
        """Whether they could be built; those that were linked anew."""
        if not names:
            return True, []
        begun = time.time()
        built = subprocess.run(
            ["sh", "deploy/build.sh", "release", *names], cwd=self.tree, capture_output=True, text=True
        )
        if built.returncode != 0:
            (self.tree.parent / "build.log").write_text(built.stdout + built.stderr)
        return built.returncode == 0, [
            name for name in names if self.program(name).exists() and
            self.program(name).stat().st_mtime >= begun
        ]

    def program(self, name):
        return self.tree / "build" / "release" / "bin" / name

    def test(self, name):
        """Nothing if all of its tests pass; else the first that does not."""
        with subprocess.Popen(
            [self.program(name), "--gtest_fail_fast", "--gtest_brief=1"],
            cwd=self.tree / "build" / "release",
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as process:
            try:
                said = process.communicate(timeout=HANGS_AFTER_S)[0].decode(errors="replace")
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                return f"{name} (hangs)"
        if process.returncode == 0:
            return None
        failed = re.findall(r"\[  FAILED  \] ([\w/]+\.[\w/]+)", said)
        return failed[0] if failed else f"{name} (ends with {process.returncode})"

    def first_failure(self, names):
        """Of programs, as many at once as there are cores. Once one has failed no other is begun."""
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            tests = [pool.submit(self.test, name) for name in names]
            for test in concurrent.futures.as_completed(tests):
                if not test.cancelled() and test.result():
                    for other in tests:
                        other.cancel()
                    return test.result()
        return None


def run(*words, cwd):
    subprocess.run([str(word) for word in words], cwd=cwd, check=True, stdout=subprocess.DEVNULL)


def measure(build, names):
    """All tests pass as the sources are; the quick ones are tried first."""
    begun = time.time()
    is_built, _ = build.make(names)
    if not is_built:
        sys.exit(f"mutation: the sources as they are do not build, see {build.tree.parent}/build.log")
    print(f"mutation: built in {time.time() - begun:.0f} s", flush=True)

    def timed(name):
        begun = time.time()
        return name, build.test(name), time.time() - begun

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, failed, seconds in pool.map(timed, names):
            if failed:
                sys.exit(f"mutation: {failed} fails with the sources as they are")
            build.programs[name] = seconds
    print(f"mutation: {len(build.programs)} programs pass in {sum(build.programs.values()):.0f} s", flush=True)


def judge(build, mutant):
    """killed, survived, or does not compile; by what."""
    build.revert()
    mutant.apply(build.tree)
    folders = build.targets()
    own = {name for name in build.programs if folders[name] == mutant.file.split("/")[1]}
    tried = 0
    for names in own, build.programs.keys() - own:
        is_built, programs = build.make(sorted(names))
        if not is_built:
            return "does not compile", None
        killer = build.first_failure(sorted(programs, key=build.programs.get))
        if killer:
            return "killed", killer
        tried += len(programs)
    return "survived", f"{tried} programs"


def report(results):
    table = collections.Counter((result["kind"], result["outcome"]) for result in results)
    print(f"\n{'kind':14}{'killed':>8}{'survived':>10}")
    for kind in mutants.KINDS:
        print(f"{kind:14}{table[kind, 'killed']:8}{table[kind, 'survived']:10}")
    for result in results:
        if result["outcome"] == "survived":
            print(f"\n{result['file']}:{result['line']} ({result['kind']}), {result['by']}")
            print(f"- {result['before'].strip()}\n+ {result['after'].strip() or '(nothing)'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=60, help="mutants that compile (60)")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "mutation")
    parser.add_argument("--own", action="store_true", help="only the tests of a mutant's own folder: quick")
    parser.add_argument("folder", nargs="*", default=FOLDERS, help="of sources, such as robot/vio")
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    kept = out / ("own_results.jsonl" if options.own else "results.jsonl")
    known = {}
    if kept.exists():
        for line in kept.read_text().splitlines():
            result = json.loads(line)
            known[tuple(result[key] for key in ("file", "line", "before", "after"))] = result
    build = Build(out)
    folders = build.targets()
    own = [name for name, folder in folders.items() if folder in (of.split("/")[1] for of in options.folder)]
    names = sorted(own if options.own else folders)
    results = []
    for mutant in mutants.draw(build.tree, options.folder, options.seed):
        if len(results) == options.count:
            break
        result = known.get((mutant.file, mutant.line, mutant.before, mutant.after))
        if not result:
            if not build.programs:
                measure(build, names)
            begun = time.time()
            outcome, by = judge(build, mutant)
            result = asdict(mutant) | {"outcome": outcome, "by": by, "seconds": round(time.time() - begun)}
            with kept.open("a") as file:
                file.write(json.dumps(result) + "\n")
        if result["outcome"] != "does not compile":
            results.append(result)
        print(f"{len(results)}/{options.count} {result['file']}:{result['line']} {result['kind']}: "
              f"{result['outcome']}, {result['by']}, {result['seconds']} s", flush=True)
    build.revert()
    report(results)


if __name__ == "__main__":
    main()
