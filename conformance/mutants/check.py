#!/usr/bin/env python3
"""Shows that the suite finds mistakes: each mutant is the reader in JavaScript with one mistake, and a test must fail for it.

    python3 mutants/check.py [--only NAME] [--jobs N]

`mutants.json` lists them: the file of `ports/js`, what is there once and what takes its place, why that is wrong, and the tests that
must fail (`killed_by`), one at least. Needs Python 3.8 and node. Ends with the line `N killed, N alive` and exits with 1 if one is alive.
"""

import argparse
import concurrent.futures
import json
import os
import shutil
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SUITE = os.path.dirname(HERE)
sys.path.insert(0, SUITE)

import run  # noqa: E402 (the runner beside this folder)

LIMIT = 10  # seconds that a mutant has for a test


def made(mutant, folder):
    """Copies the reader and its adapter with the mistake; gives the command."""
    for part in ("ports/js", "adapters/js"):
        shutil.copytree(os.path.join(SUITE, part), os.path.join(folder, part))
    path = os.path.join(folder, "ports/js", mutant["file"])
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if text.count(mutant["find"]) != 1:
        raise ValueError("%s: what it replaces is not there once" % mutant["name"])
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace(mutant["find"], mutant["replace"]))
    return "node '%s'" % os.path.join(folder, "adapters/js/adapter.mjs")


def survived(suite, mutant):
    """The tests that should fail and do not; the reason, if the mutant does not run at all."""
    with tempfile.TemporaryDirectory() as folder:
        decoder = run.Run(suite, made(mutant, folder), LIMIT)
        if not decoder.capabilities.lines:
            return ["it does not start"]
        passed = []
        for name in mutant["killed_by"]:
            answer, _ = decoder.answer(suite.by_id[name], os.path.join(folder, "out"), [])
            if answer["status"] != "failed":
                passed.append(name)
        return passed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="mutants whose name contains this")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    with open(os.path.join(HERE, "mutants.json"), encoding="utf-8") as file:
        mutants = [mutant for mutant in json.load(file) if options.only in mutant["name"]]
    suite = run.find_suite(None)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda mutant: survived(suite, mutant), mutants))
    alive = 0
    for mutant, passed in zip(mutants, results):
        if passed or not mutant["killed_by"]:
            alive += 1
            print("alive: %s (%s): %s" % (mutant["name"], mutant["why"], ", ".join(passed) or "no test named"))
        else:
            print("killed: %s by %s" % (mutant["name"], ", ".join(mutant["killed_by"])))
    print("%d killed, %d alive" % (len(mutants) - alive, alive))
    return 1 if alive or not mutants else 0


if __name__ == "__main__":
    sys.exit(main())
