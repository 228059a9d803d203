#!/usr/bin/env python3
"""Runs the conformance suite of .ivg and .pmesh on any decoder. Needs Python 3.8 and nothing else.

    python3 run.py run --decoder 'CMD' [--only PATTERN] [--skip FILE] [--json FILE] [--junit FILE] [--jobs N]
    python3 run.py list [--only PATTERN]
    python3 run.py explain ID [--decoder 'CMD']

CMD is the command of an adapter: PROTOCOL.md. `run` may be left out. `ivg conformance` is the same program in Rust, with the
same results.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import shlex
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
from xml.sax.saxutils import escape

MANIFEST = 2  # the version of the manifest's form
VERDICTS = {"ok": 0, "need-more": 40, "invalid": 41, "unsupported": 42, "limit": 43}
NAMES = {status: name for name, status in VERDICTS.items()}
TABLES_TAKE = 6  # a table may take so many times as long as another test
HANGS = 3  # after so many tests without an answer nothing more is started
NOTHING = 0xFFFFFFFF
LISTED = 40  # failed tests that are listed
COMPLAINTS = 3  # lines of standard error that are shown of a failed test
KEPT = 64 << 10  # bytes that are kept of what a decoder prints
CLAUSES = 12  # clauses that are named of those of which every test failed
HEMISPHERES = ("+x", "-x", "+y", "-y", "+z", "-z")  # IVG-DEF-03
CHANNELS, COORDINATES = "RGB", "xyz"
COEFFICIENTS = 9  # of harmonics of a channel
NEXT_CLAUSE = r"\n(?=\*\*[A-Z]+-[A-Z]+-[0-9]+\*\*|#)"


# ---- The suite ----


class Suite:
    def __init__(self, folder):
        self.folder = folder
        with open(os.path.join(folder, "manifest.json"), encoding="utf-8") as file:
            manifest = json.load(file)
        if manifest["manifest"] != MANIFEST:
            raise ValueError("form %s of the manifest, this program reads %d" % (manifest["manifest"], MANIFEST))
        self.tests = manifest["tests"]
        self.by_id = {test["id"]: test for test in self.tests}

    def path(self, name):
        return os.path.join(self.folder, name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def expected(self, out):
        """What OUT must hold, byte by byte; None where only hashes of rows are known."""
        data = self.read(out["file"])
        if out["form"] == "bytes":
            return data
        if out["form"] == "rows":
            return None
        table = bytearray()
        for line in data.decode("ascii").splitlines()[1:]:
            first, last, verdict, records = line.split("\t")
            row = struct.pack("<II", VERDICTS[verdict], int(records))
            table += row * (int(last) + 1 - int(first))
        return bytes(table)


def find_suite(named):
    here = os.path.dirname(os.path.abspath(__file__))
    for folder in [named] if named else [os.path.join(here, "vectors"), "conformance/vectors", "vectors"]:
        if named or os.path.exists(os.path.join(folder, "manifest.json")):
            return Suite(folder)
    raise ValueError("no suite here: name its folder of vectors with --suite")


def fits(pattern, name):
    """`*` stands for any characters; a pattern without one fits every id that contains it."""
    first, star, rest = pattern.partition("*")
    if not star:
        return pattern in name
    if not name.startswith(first):
        return False
    left = name[len(first) :]
    parts = rest.split("*")
    for part in parts[:-1]:
        at = left.find(part)
        if at < 0:
            return False
        left = left[at + len(part) :]
    return left.endswith(parts[-1])


# ---- What the decoder claims ----


class Capabilities:
    def __init__(self, text):
        lines = {}
        for line in text.splitlines():
            words = line.split()
            if words:
                lines[words[0]] = words[1:]
        # Who names no format is tested in everything.
        self.lines = lines if "ivg" in lines or "pmesh" in lines else {}

    def name(self):
        return " ".join(self.lines["name"]) if "name" in self.lines else None

    def knows(self, key, value):
        return value is None or key not in self.lines or value in self.lines[key]

    def plan(self, test):
        """None if it is not claimed; else the verdicts that are right, the code, whether OUT is compared."""
        verdicts = [test["verdict"]] + test.get("also", [])
        if not self.lines:
            return verdicts, test.get("code"), "out" in test
        if "format" in test:
            commands = self.lines.get(test["format"])
            claimed = commands is not None and (test["op"] == "decode" or test["op"] in commands)
        else:
            claimed = test.get("args") in self.lines.get("numeric", [])
        if not claimed:
            return None
        needs = test.get("needs", {})
        known = [self.knows(key + "s", needs.get(key)) for key in ("encoding", "order", "mode")]
        if not all(known):
            return None if test["op"] == "prefixes" else (["unsupported"], None, False)
        return verdicts, test.get("code") if "codes" in self.lines else None, "out" in test


# ---- Running ----


def start(words, limit):
    """How a program ended (a kind and a number or text), the beginnings of what it printed and complained of."""
    try:
        # In a session of its own, so that those that a script starts can be ended with it.
        pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        child = subprocess.Popen(words, start_new_session=True, **pipes)
    except OSError as error:
        return ("not started", 0), "", str(error)
    kept = [b"", b""]

    def keep(number, stream):
        with stream:
            for block in iter(lambda: stream.read1(4096), b""):
                kept[number] += block[: KEPT - len(kept[number])]

    streams = enumerate([child.stdout, child.stderr])
    threads = [threading.Thread(target=keep, args=pair, daemon=True) for pair in streams]
    for thread in threads:
        thread.start()
    try:
        status = child.wait(limit)
        for thread in threads:
            thread.join()
        end = ("status", status) if status >= 0 else ("signal", -status)
    except subprocess.TimeoutExpired:
        end_all(child)
        end = ("hung", 0)
    text = [data.decode("utf-8", "replace") for data in kept]
    return end, text[0], text[1]


def end_all(child):
    """Kills a program and those that it started."""
    try:
        os.killpg(child.pid, signal.SIGKILL)
    except (AttributeError, OSError):
        child.kill()
    child.wait()


def seen(end, stdout):
    """What came, its verdict, and the code that was printed."""
    kind, value = end
    if kind == "signal":
        return "killed by signal %d" % value, None, None
    if kind == "hung":
        return "no answer in time", None, None
    if kind == "not started":
        return "could not be started", None, None
    verdict = NAMES.get(value)
    if verdict is None:
        return "exit status %d, which is no verdict" % value, None, None
    if verdict in ("ok", "need-more"):
        return verdict, verdict, None
    numbers = (stdout.splitlines() or [""])[0].split()
    numbers = [int(word) if word.isdigit() and word.isascii() else None for word in numbers[:2]]
    code = numbers[0] if numbers else None
    found = verdict
    if code is not None:
        found += " %d" % code
        if len(numbers) > 1 and numbers[1] is not None:
            found += " at %d" % numbers[1]
    return found, verdict, code


class Run:
    def __init__(self, suite, decoder, limit):
        self.suite, self.limit = suite, limit
        self.command = shlex.split(decoder)
        if not self.command:
            raise ValueError("the command is empty")
        end, stdout, _ = start(self.command + ["capabilities"], limit)
        self.capabilities = Capabilities(stdout if end == ("status", 0) else "")
        self.hangs = int(end[0] == "hung")
        self.decoder = self.capabilities.name() or decoder
        self.lock = threading.Lock()

    def answer(self, test, out, skip):
        answer = {"id": test["id"], "status": "skipped"}
        if any(fits(pattern, test["id"]) for pattern in skip):
            return answer, ""
        plan = self.capabilities.plan(test)
        if plan is None:
            answer["status"] = "not-claimed"
            return answer, ""
        verdicts, code, compared = plan
        expected = " or ".join(verdicts) + (" %d" % code if code is not None else "")
        answer["status"], answer["expected"] = "failed", expected
        if self.hangs >= HANGS:
            answer["detail"] = "not started: the decoder gave no answer %d times" % HANGS
            tell(answer, test)
            return answer, ""
        words = [test["op"]]
        if "format" in test:
            words += [test["format"], self.suite.path(test["file"]), out] + ([test["args"]] if "args" in test else [])
        else:
            words += [test["args"], out]
        limit = self.limit * (TABLES_TAKE if test["op"] == "numeric" else 1)
        end, stdout, stderr = start(self.command + words, limit)
        if end[0] == "hung":
            with self.lock:
                self.hangs += 1
        found, verdict, printed = seen(end, stdout)
        answer["found"] = found
        detail = ""
        if verdict is None:
            detail = found
        elif verdict not in verdicts:
            detail = "expected %s, found %s" % (expected, found)
        elif verdict in ("ok", "need-more") and not os.path.exists(out):
            detail = "OUT was not written"
        elif verdict == test["verdict"]:
            if code is not None and printed is None:
                detail = "expected the code %d, found no code on standard output" % code
            elif code is not None and printed != code:
                detail = "expected %s, found %s" % (expected, found)
            elif compared:
                detail = self.compare(test, out)
        if detail:
            answer["detail"] = detail
            tell(answer, test)
        else:
            answer["status"] = "passed"
        return answer, stderr

    def compare(self, test, out):
        """In what OUT differs; nothing if it does not."""
        expected = test["out"]
        if expected["form"] == "rows":
            return compare_rows(out, self.suite.read(expected["file"]), expected["bytes"])
        with open(out, "rb") as file:
            found = file.read(expected["bytes"] + 1)
        if hashlib.sha256(found).hexdigest() == expected["sha256"]:
            return ""
        return difference(test, self.suite.expected(expected), found) or "the suite is damaged"


def tell(answer, test):
    """What a failed test shows, for who has only the report."""
    answer["why"] = test["why"]
    if test.get("clauses"):
        answer["clauses"] = test["clauses"]


def compare_rows(out, hashes, length):
    found = os.path.getsize(out)
    if found != length:
        return "OUT has %d bytes, expected %d" % (found, length)
    rows = len(hashes) // 8
    size = length // rows
    with open(out, "rb") as file:
        for row in range(rows):
            if hashlib.sha256(file.read(size)).digest()[:8] != hashes[8 * row : 8 * row + 8]:
                return "row %d of %d differs (bytes %d to %d)" % (row, rows, row * size, row * size + size - 1)
    return ""


# ---- Where the numbers of an OUT lie (PROTOCOL.md, "What OUT holds") ----


class Walk:
    def __init__(self, out):
        self.out, self.at, self.fields = out, 0, []

    def put(self, name, size, count, kind="whole"):
        if count > 0:
            self.fields.append((name, self.at, size, count, kind))
        self.at += size * count

    def word(self, at):
        data = self.out[at : at + 4]
        return int.from_bytes(data, "little") if len(data) == 4 else 0

    def next(self, name):
        word = self.word(self.at)
        self.put(name, 4, 1)
        return word

    def text(self, name, length):
        if length != NOTHING:
            self.put(name, 1, length)

    def ended(self):
        return self.at >= len(self.out)


def fields(test, out):
    walk = Walk(out)
    if not out:
        return []
    if test["op"] == "numeric":
        walk.put("components", 4, len(out) // 4, "f32")
    elif test["op"] == "prefixes":
        walk.put("statuses and records", 4, len(out) // 4)
    elif test.get("format") == "ivg":
        grid(walk)
    else:
        mesh(walk)
    return walk.fields


def grid(walk):
    vertices = walk.word(0) * walk.word(4) * walk.word(8)
    walk.put("dims", 4, 3)
    walk.put("origin", 8, 3, "f64")
    walk.put("step", 8, 3, "f64")
    walk.put("units", 4, 1)
    walk.put("quantity", 4, 1)
    lights = walk.next("lights")
    for light in range(0 if lights == NOTHING else lights):
        if walk.ended():
            return
        walk.put("light %d, direct" % light, 4, 1)
        length = walk.next("light %d, bytes of the name" % light)
        walk.text("light %d, name" % light, length)
    length = walk.next("bytes of the metadata")
    walk.text("metadata", length)
    for name in ("received", "validity", "blocked"):
        walk.put(name, 1, vertices)
    walk.put("values", 4, max(0, len(walk.out) - walk.at) // 4, "f32")


def mesh(walk):
    walk.put("origin", 8, 3, "f64")
    attributes = walk.next("attributes")
    walk.put("counts", 4, 4)
    for packet in range(walk.next("packets")):
        if walk.ended():
            return
        walk.put("packet %d" % packet, 4, 4)
        walk.put("packet %d, error" % packet, 4, 1, "f32")
    names = walk.next("materials' names")
    for name in range(0 if names == NOTHING else names):
        if walk.ended():
            return
        length = walk.next("bytes of name %d" % name)
        walk.text("name %d" % name, length)
    if walk.next("level") == NOTHING:
        return
    vertices, wedges, faces = (walk.word(walk.at + at) for at in (0, 4, 8))
    walk.put("level's counts", 4, 3)

    def has(bit, count):
        return count if attributes >> bit & 1 else 0

    walk.put("positions", 4, 3 * vertices, "f32")
    walk.put("wedges", 4, wedges)
    walk.put("normals", 4, has(0, 3 * wedges), "f32")
    walk.put("texture coordinates", 4, has(1, 2 * wedges), "f32")
    walk.put("colours", 1, has(2, 4 * wedges))
    walk.put("corners", 4, 3 * faces)
    walk.put("materials", 2, has(3, faces))


def difference(test, expected, found):
    """The first number in which two OUTs differ; None if they are the same."""
    lengths = "OUT has %d bytes, expected %d" % (len(found), len(expected))
    at = next((n for n, (a, b) in enumerate(zip(expected, found)) if a != b), None)
    if at is None:
        return None if len(expected) == len(found) else lengths + "; the same up to there"
    all_fields = fields(test, expected)
    before = [field for field in all_fields if field[1] <= at]
    if not before:
        return "byte %d differs; %s" % (at, lengths)
    name, begin, size, count, kind = before[-1]
    index = (at - begin) // size
    place = begin + index * size

    def show(out):
        data = out[place : place + size]
        if len(data) < size:
            return "nothing"
        whole = int.from_bytes(data, "little")
        if kind == "whole":
            return str(whole)
        number = struct.unpack("<f" if size == 4 else "<d", data)[0]
        return "%s (0x%0*X)" % (decimal(number), 2 * size, whole)

    if test["op"] == "prefixes":
        name = "after %d bytes: %s" % (index // 2, ["exit status", "records"][index % 2])
    elif name == "values":
        name = "values[%d], %s" % (index, value_name(all_fields, expected, index))
    elif count != 1:
        name = "%s[%d]" % (name, index)
    also = "" if len(expected) == len(found) else "; " + lengths
    return "%s (byte %d): expected %s, found %s%s" % (name, place, show(expected), show(found), also)


def decimal(number):
    """Seven digits, as the runner in Rust writes them."""
    text = "%.6e" % number
    digits, e, exponent = text.partition("e")
    return "%se%d" % (digits, int(exponent)) if e else text.replace("nan", "NaN")


def value_name(all_fields, out, index):
    """Which number of which vertex a value of a grid is."""
    held = {name: out[at : at + size * count] for name, at, size, count, _ in all_fields if name in ("quantity", "received")}
    harmonics = held.get("quantity") == b"\1\0\0\0"
    of_hemisphere = len(CHANNELS) * len(COORDINATES)
    each = len(CHANNELS) * COEFFICIENTS if harmonics else len(HEMISPHERES) * of_hemisphere
    arrived = [vertex for vertex, received in enumerate(held.get("received", b"")) if received == 1]
    vertex, number = divmod(index, each)
    vertex = "vertex %d" % arrived[vertex] if vertex < len(arrived) else "no vertex"
    if harmonics:
        return "%s, %s, coefficient %d" % (vertex, CHANNELS[number // COEFFICIENTS], number % COEFFICIENTS)
    hemisphere, number = divmod(number, of_hemisphere)
    channel, coordinate = divmod(number, len(COORDINATES))
    return "%s, hemisphere %s, %s, %s" % (vertex, HEMISPHERES[hemisphere], CHANNELS[channel], COORDINATES[coordinate])


# ---- Commands ----


def run_tests(suite, decoder, tests, skip, jobs, limit):
    run = Run(suite, decoder, limit)
    with tempfile.TemporaryDirectory() as folder:

        def one(numbered):
            number, test = numbered
            out = os.path.join(folder, "out-%d" % number)
            answer = run.answer(test, out, skip)
            if os.path.exists(out):
                os.remove(out)
            return answer

        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            return run.decoder, list(pool.map(one, enumerate(tests)))


def counts(answers):
    names = ("passed", "failed", "not-claimed", "skipped")
    return {name: sum(answer["status"] == name for answer, _ in answers) for name in names}


def telling(failed):
    """As many failed tests as are listed: those first that are about another clause than the ones before, in the order of the suite."""
    clauses, new, others = set(), [], []
    for number, (answer, _) in enumerate(failed):
        mine = set(answer.get("clauses", []))
        (others if mine <= clauses else new).append(number)
        clauses |= mine
    return [failed[number] for number in sorted((new + others)[:LISTED])]


def broken(suite, answers):
    """The clauses of which a test failed and none passed, those with the most failed tests first."""
    failed, passed = {}, set()
    for answer, _ in answers:
        for clause in suite.by_id[answer["id"]].get("clauses", []):
            if answer["status"] == "failed":
                failed[clause] = failed.get(clause, 0) + 1
            elif answer["status"] == "passed":
                passed.add(clause)
    return sorted((clause for clause in failed if clause not in passed), key=lambda clause: (-failed[clause], clause))


def show_run(suite, decoder, answers, took):
    count = counts(answers)
    failed = [(answer, stderr) for answer, stderr in answers if answer["status"] == "failed"]
    listed = telling(failed)
    for answer, stderr in listed:
        print("FAILED %s: %s" % (answer["id"], answer["detail"]))
        for line in stderr.splitlines()[:COMPLAINTS]:
            print("    | " + line)
    if len(failed) > LISTED:
        print("and %d more; --json FILE lists all" % (len(failed) - LISTED))
    nothing_passed = broken(suite, answers)
    if nothing_passed:
        more = ", and %d more" % (len(nothing_passed) - CLAUSES) if len(nothing_passed) > CLAUSES else ""
        print("every test of these clauses failed: %s%s" % (", ".join(nothing_passed[:CLAUSES]), more))
    if listed:
        print("what is in a test, and why: explain %s" % listed[0][0]["id"])
    print("%s, in %.1f s" % (decoder, took))
    line = "%d passed, %d failed" % (count["passed"], count["failed"])
    line += ", %d not claimed" % count["not-claimed"] if count["not-claimed"] else ""
    line += ", %d skipped" % count["skipped"] if count["skipped"] else ""
    print(line)
    return 1 if count["failed"] else 0


def command_run(suite, args):
    skip = []
    if args.skip:
        with open(args.skip, encoding="utf-8") as file:
            skip = [line for line in (line.split("#")[0].strip() for line in file) if line]
    tests = [test for test in suite.tests if args.only is None or fits(args.only, test["id"])]
    if not tests:
        raise ValueError("no test fits")
    began = time.monotonic()
    decoder, answers = run_tests(suite, args.decoder, tests, skip, args.jobs, args.timeout)
    took = time.monotonic() - began
    count = counts(answers)
    if args.json:
        report = {"decoder": decoder, "passed": count["passed"], "failed": count["failed"]}
        report.update(not_claimed=count["not-claimed"], skipped=count["skipped"])
        report["tests"] = [answer for answer, _ in answers]
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump(report, file, indent=2, ensure_ascii=False)
            file.write("\n")
    if args.junit:
        with open(args.junit, "w", encoding="utf-8") as file:
            file.write(junit(answers, count))
    return show_run(suite, decoder, answers, took)


def junit(answers, count):
    quote = {'"': "&quot;"}
    left_out = count["not-claimed"] + count["skipped"]
    text = '<?xml version="1.0" encoding="UTF-8"?>\n<testsuite name="conformance" tests="%d" failures="%d" skipped="%d">\n'
    text %= (len(answers), count["failed"], left_out)
    for answer, _ in answers:
        inner = {"not-claimed": '<skipped message="not claimed"/>', "skipped": "<skipped/>"}.get(answer["status"], "")
        if answer["status"] == "failed":
            about = "; ".join([answer["why"]] + answer.get("clauses", []))
            inner = '<failure message="%s">%s</failure>' % (escape(answer["detail"], quote), escape(about, quote))
        text += '  <testcase name="%s">%s</testcase>\n' % (escape(answer["id"], quote), inner)
    return text + "</testsuite>\n"


def command_list(suite, args):
    for test in suite.tests:
        if args.only is None or fits(args.only, test["id"]):
            code = " %d" % test["code"] if "code" in test else ""
            print("%s\t%s\t%s%s\t%s" % (test["id"], test["kind"], test["verdict"], code, test["why"]))
    return 0


def command_explain(suite, args):
    test = suite.by_id.get(args.id)
    if test is None:
        raise ValueError("there is no test %s; `list` names all" % args.id)
    print("%s\n  %s" % (test["id"], test["why"]))

    def line(name, value):
        if value:
            print("  %-10s %s" % (name, value))

    words = [test["op"], test.get("format"), test.get("file"), "OUT", test.get("args")]
    if "format" not in test:
        words = [test["op"], test["args"], "OUT"]
    line("command", "CMD " + " ".join(word for word in words if word))
    code = " %d" % test["code"] if "code" in test else ""
    also = "".join(" or " + verdict for verdict in test.get("also", []))
    line("expected", "%s%s%s (exit status %d)" % (test["verdict"], code, also, VERDICTS[test["verdict"]]))
    if "out" in test:
        line("OUT", "%(bytes)d bytes, %(form)s: %(file)s" % test["out"])
    line("bug class", test.get("bug_class"))
    line("twin", test.get("twin"))
    line("mistakes", " before ".join(test.get("both", [])))
    line("whole file", test.get("of"))
    recipe = test.get("recipe") or suite.by_id.get(test.get("of"), {}).get("recipe")
    if recipe:
        line("made of", "%s by %d edits" % (recipe["from"], len(recipe["edits"])))
        line("checksums", ", ".join(recipe.get("checksums", [])))
        show_edits(suite.read(suite.by_id[recipe["from"]]["file"]), recipe["edits"])
    for clause in test.get("clauses", []):
        print("\n" + clause_text(suite, clause))
    if args.decoder:
        began = time.monotonic()
        decoder, answers = run_tests(suite, args.decoder, [test], [], 1, 10)
        print()
        return show_run(suite, decoder, answers, time.monotonic() - began)
    return 0


def show_edits(twin, edits):
    """The bytes of the twin around each edit, what goes in brackets, and what comes there."""
    for edit in edits[:6]:
        at, delete = edit["at"], edit["delete"]
        print("\n  %s, at %d (0x%X):" % (edit["field"], at, at))
        first = max(0, at // 16 - 1)
        last = min((at + max(delete, 1) - 1) // 16 + 1, first + 7)
        for start_of_line in range(16 * first, 16 * last + 1, 16):
            data = twin[start_of_line : start_of_line + 16]
            cells = ["[%02X]" if at <= start_of_line + n < at + delete else " %02X " for n in range(len(data))]
            if data:
                print("    %06X %s" % (start_of_line, "".join(cells) % tuple(data)))
        shown = edit["insert"][:256].upper() + (" ..." if len(edit["insert"]) > 256 else "")
        times = ", %d times" % edit["repeat"] if "repeat" in edit else ""
        print("    %s: %s%s" % ("becomes" if delete else "there comes in", shown or "nothing", times))
    if len(edits) > 6:
        print("\n  and %d edits more" % (len(edits) - 6))


def clause_text(suite, clause):
    """What the specification says of it, up to the next clause or heading, if it lies beside the suite."""
    for folder in ("spec", "../spec", "../../spec"):
        for document in ("common.md", "ivg.md", "pmesh.md"):
            path = os.path.join(suite.folder, folder, document)
            if os.path.exists(path):
                with open(path, encoding="utf-8") as file:
                    text = "\n" + file.read()
                start = text.find("\n**%s**" % clause)
                if start >= 0:
                    return re.split(NEXT_CLAUSE, text[start + 1 :])[0].rstrip()
    return clause


def main(arguments):
    parser = argparse.ArgumentParser(description="Runs the conformance suite of .ivg and .pmesh on any decoder.")
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="run the suite; the last line is `N passed, N failed`")
    run.add_argument("--decoder", required=True, metavar="CMD", help="command of the decoder's adapter: PROTOCOL.md")
    run.add_argument("--skip", metavar="FILE", help="tests to leave out: one pattern a line")
    run.add_argument("--json", metavar="FILE", help="write all results")
    run.add_argument("--junit", metavar="FILE", help="write all results as JUnit XML")
    run.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="tests at a time")
    run.add_argument("--timeout", type=float, default=10, metavar="SECONDS", help="for a test; a table six times as long")
    listing = commands.add_parser("list", help="id, kind, verdict and code, what each test shows")
    for command in (run, listing):
        command.add_argument("--only", metavar="PATTERN", help="tests whose id contains this, or fits it with its *")
    explaining = commands.add_parser("explain", help="everything about one test")
    explaining.add_argument("id")
    explaining.add_argument("--decoder", metavar="CMD", help="run it too")
    for command in (run, listing, explaining):
        command.add_argument("--suite", metavar="DIR", help="folder of the vectors")
    if arguments and arguments[0].startswith("-") and arguments[0] not in ("-h", "--help"):
        arguments = ["run"] + arguments
    args = parser.parse_args(arguments)
    try:
        suite = find_suite(args.suite)
        return {"run": command_run, "list": command_list, "explain": command_explain}[args.command](suite, args)
    except (OSError, ValueError) as error:
        print("run.py: %s" % error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BrokenPipeError:
        sys.exit(1)
