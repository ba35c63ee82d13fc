#!/usr/bin/env python3
"""check_pages.py tests|values|profiles|phrases ROOT: do the pages still say what is true?

tests:    every test that a page names exists, and test/promises.md names one for each promise.
values:   thresholds in the tables of robot/ and cloud/README.md are those of deploy/config.
profiles: the table of qos_profiles/README.md has the values of the profiles.
phrases:  what deploy/README.md says that programs say is in the sources.
"""

import fnmatch
import re
import sys
import xml.etree.ElementTree
from pathlib import Path

ROOMS = ["shared", "robot", "cloud", "deploy", "test"]


def pages(root):
    folders = ["idl", "qos_profiles", *ROOMS]
    return [root / "README.md"] + sorted(p for f in folders for p in (root / f).rglob("*.md"))


def rows(page, section=""):
    """Cells of each line of the page's tables, but for the lines that rule them off. With a section
    only those below a heading that begins so."""
    heading = ""
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if line.startswith("#"):
            heading = line.lstrip("# ")
        if line.startswith("|") and not line.startswith("|--") and heading.startswith(section):
            yield number, [cell.strip() for cell in line.strip("|").split("|")]


# Tests


def tests_of(root):
    """Suite.Name of each test: GoogleTest's of the sources that are built, and CTest's own."""
    names = set()
    for file in (root / "test").rglob("CMakeLists.txt"):
        text = file.read_text()
        names.update(re.findall(r"add_test\(NAME (\S+)", text))
        for word in re.findall(r"\S+_test\.cpp", text):
            # A test of several folders names them from above.
            for source in {file.parent / word, file.parent.parent / word}:
                if source.is_file():
                    found = re.findall(
                        r"^(?:TYPED_)?TEST(?:_[FP])?\(\s*(\w+)\s*,\s*(\w+)\s*\)",
                        source.read_text(),
                        re.MULTILINE,
                    )
                    names.update(".".join(name) for name in found)
    return names


def check_tests(root):
    tests = tests_of(root)
    print(f"{len(tests)} tests")
    if len(tests) < 1000:
        yield "the tests were not found"
    count = 0
    for page in pages(root):
        where = page.relative_to(root)
        text = page.read_text()
        for name in re.findall(r"`([A-Z]\w+\.(?:\*|[A-Z]\w*(?:\*|\.\.\.)?))`", text):
            count += 1
            pattern = name.replace("...", "*")
            if not fnmatch.filter(tests, pattern):
                yield f"{where}: there is no test {name}"
        for name in re.findall(r"`…(\w+)`", text):
            count += 1
            if not fnmatch.filter(tests, f"*{name}"):
                yield f"{where}: there is no test …{name}"
        for name in re.findall(r"ctest[^`\n]*-R\s+'?([\w.]+)", text):
            count += 1
            if not any(re.search(name, test) for test in tests):
                yield f"{where}: ctest -R {name} finds nothing"
        for name in re.findall(r"`(test/[\w/]+\.(?:sh|py))\b", text):
            count += 1
            if not (root / name).is_file():
                yield f"{where}: there is no {name}"
    promises = root / "test" / "promises.md"
    for number, cells in rows(promises):
        names = re.search(r"`(?:[A-Z]\w+\.[A-Z*]\w*\*?|test/\S+)`", cells[-1])
        if cells[-1] != "test" and not names:
            yield f"test/promises.md:{number}: no test keeps this promise"
    print(f"{count} names of tests in {len(pages(root))} pages")


# Values


def configured(file):
    """{path of keys: number} of a file of deploy/config, which has one key a line."""
    values = {}
    path = []
    for line in file.read_text().splitlines():
        match = re.match(r"( *)(\w+):\s*([^#\s]*)", line)
        if not match:
            continue
        depth = len(match[1]) // 2
        path = path[:depth] + [match[2]]
        try:
            values[".".join(path)] = float(match[3])
        except ValueError:
            pass  # a section, or not a number
    return values


def check_values(root):
    count = 0
    for room in ["robot", "cloud"]:
        page = root / room / "README.md"
        values = configured(root / "deploy" / "config" / f"{room}.yaml")
        for number, cells in rows(page):
            line = " | ".join(cells)
            for key, value in re.findall(r"`([a-z_.]+)` (\d+(?:\.\d+)?)(?=[,. ]|$)", line):
                found = [v for path, v in values.items() if f".{path}".endswith(f".{key}")]
                count += 1
                if float(value) not in found:
                    is_now = found or "not configured"
                    yield f"{room}/README.md:{number}: {key} is {is_now}, not {value}"
    print(f"{count} values")
    if count < 30:
        yield "the tables were not found"


# Profiles


class Profile:
    """Values of a file of qos_profiles: the texts of elements with a name below a parent's path."""

    def __init__(self, file):
        text = re.sub(r'\sxmlns="[^"]*"', "", file.read_text())
        self.root = xml.etree.ElementTree.fromstring(text.encode())

    def number(self, path, otherwise):
        """Of seconds with a fraction, or of a plain element."""
        element = self.root.find(path)
        if element is None:
            return otherwise
        if len(element):
            nanoseconds = float(element.findtext("nanosec", "0"))
            return float(element.findtext("sec", "0")) + nanoseconds / 1e9
        return float(element.text)

    def participant(self, name, path, otherwise=None):
        return self.number(f".//participant[@profile_name='{name}']//{path}", otherwise)

    def property(self, participant, name):
        for element in self.root.iterfind(
            f".//participant[@profile_name='{participant}']//property"
        ):
            if element.findtext("name") == name:
                return float(element.findtext("value"))
        return None

    def writer(self, name, path, otherwise):
        return self.number(f".//data_writer[@profile_name='{name}']//{path}", otherwise)

    def buffer(self, transport, kind):
        for element in self.root.iterfind(".//transport_descriptor"):
            if element.findtext("transport_id") == transport and element.find(kind) is not None:
                return float(element.findtext(kind))
        return None


def text_of(number):
    return f"{number:g}"


def stated(profile):
    """What the table says of a profile, by the beginning of its row. Defaults of the library, and
    what a reader cannot compare, are left out."""

    def limit(participant):
        value = profile.property(participant, "fleetloc.max_discovery_bytes_per_s")
        return None if value is None else text_of(value / 1000)

    robot, cloud = limit("robot"), limit("cloud")
    flow = profile.number(".//throughputController/bytesPerPeriod", None)
    period_ms = profile.number(".//throughputController/periodMillisecs", None)
    count = profile.participant("robot", "initialAnnouncements/count")
    pause = profile.participant("robot", "initialAnnouncements/period")
    kinds = [
        (name, profile.buffer(transport, kind))
        for name, transport, kind in [
            ("receive buffer, robot", "udp", "receiveBufferSize"),
            ("receive buffer, localizer", "udp_cloud", "receiveBufferSize"),
            ("send buffer", "udp", "sendBufferSize"),
        ]
    ]
    lines = {
        "announcements every": text_of(profile.participant("robot", "leaseAnnouncement")) + " s",
        "lease": text_of(profile.participant("robot", "leaseDuration")) + " s",
        "maxMessageSize`": text_of(profile.number(".//maxMessageSize", None)),
        "limit of discovery": "none" if robot is None else f"{robot}, {cloud} KB/s",
        "copies": text_of(profile.property("robot", "fleetloc.max_copies") or 1),
        "flow control": "none" if flow is None else text_of(flow / period_ms) + " KB/s",
    }
    if count is not None:
        lines["first announcements"] = f"{text_of(count)} in {text_of(count * pause)} s"
    for name, size in kinds:
        if size is None:
            lines[name] = "kernel's"
        else:
            lines[name] = (
                f"{size / 2**20:g} MB" if size >= 2**20 else f"{size / 2**10:g} KB"
            )
    for topic in ["session", "localizers"]:
        lines[f"heartbeats of `session`, `localizers`/{topic}"] = (
            text_of(profile.writer(topic, "heartbeatPeriod", 3.0)) + " s"
        )
        value = profile.writer(topic, "nackSupressionDuration", 0.0)
        lines[f"nackSupressionDuration`/{topic}"] = text_of(value) + (" s" if value else "")
    for topic in ["submap", "localization"]:
        lines[f"depth of/{topic}"] = text_of(profile.writer(topic, "historyQos/depth", 1.0))
    return lines


def endpoint_faults(profile):
    """What the first table of the page promises of endpoints, for all networks."""
    kinds = {
        "submap": ("BEST_EFFORT", "VOLATILE"),
        "localization": ("BEST_EFFORT", "VOLATILE"),
        "robot_status": ("BEST_EFFORT", "VOLATILE"),
        "session": ("RELIABLE", "TRANSIENT_LOCAL"),
        "localizers": ("RELIABLE", "TRANSIENT_LOCAL"),
        "pose": ("BEST_EFFORT", "VOLATILE"),
    }
    for topic, expected in kinds.items():
        for side in ["data_writer", "data_reader"]:
            qos = profile.root.find(f".//{side}[@profile_name='{topic}']/qos")
            if qos is None:
                yield f"no {side} {topic}"
                continue
            found = (
                qos.findtext("reliability/kind", "not stated"),
                qos.findtext("durability/kind", "VOLATILE"),
            )
            if found != expected:
                yield f"{side} {topic} is {found}, not {expected}"
    # Of all others they are the library's, which a firewall knows.
    for name, expected in [("robot", None), ("cloud", None), ("local", 7525)]:
        base = profile.participant(name, "portBase")
        if base != expected:
            yield f"the ports of {name} begin at {base}, not {expected or 7400}"
    transport = profile.root.findtext(".//participant[@profile_name='local']//transport_id")
    for element in profile.root.iterfind(".//transport_descriptor"):
        addresses = [a.text for a in element.iterfind("interfaceWhiteList/address")]
        if element.findtext("transport_id") == transport and addresses != ["127.0.0.1"]:
            yield f"the participant local is bound to {addresses or 'nothing'}"


def check_profiles(root):
    networks = ["lan", "wifi", "lte", "nbiot"]
    table = {}
    for number, cells in rows(root / "qos_profiles" / "README.md", "What is in a profile"):
        if len(cells) == 6:
            table[cells[0].strip("`")] = (number, dict(zip(networks, cells[1:])))
    count = 0
    for network in networks:
        profile = Profile(root / "qos_profiles" / f"{network}.xml")
        for fault in endpoint_faults(profile):
            yield f"qos_profiles/{network}.xml: {fault}"
        for name, value in stated(profile).items():
            row = [r for r in table if r.startswith(name.split("/")[0].rstrip("`"))]
            if not row:
                yield f"qos_profiles/README.md: no row {name}"
                continue
            number, says = table[row[0]]
            count += 1
            if says[network] != value:
                yield (
                    f"qos_profiles/README.md:{number}: {name} of {network} is {value}, "
                    f"not {says[network]}"
                )
    watching = Profile(root / "qos_profiles" / "monitor.xml")
    for name in ["monitor", "monitored"]:
        if watching.participant(name, "portBase") != 7587:
            yield f"qos_profiles/monitor.xml: the ports of {name} do not begin at 7587"
    print(f"{count} values")


# Phrases


def check_phrases(root):
    sources = ""
    for room in ROOMS[:-1]:
        for file in sorted((root / room).rglob("*.[ch]pp")):
            sources += file.read_text()
    sources += (root / "deploy" / "packages" / "start.sh").read_text()
    sources = re.sub(r"//.*", "", sources)
    sources = re.sub(r'"\s*"', "", sources)  # one literal over several lines
    said = "\n".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', sources))
    count = 0
    for number, cells in rows(root / "deploy" / "README.md"):
        if number < heading_line(root / "deploy" / "README.md", "## Troubleshooting by symptom"):
            continue
        for span in re.findall(r"`([^`]+)`", cells[0]):
            # Names stand in capitals, and programs put together what colons and commas part.
            for part in re.split(r"\b(?:NAME|OTHER|ID|N)\b|\.\.\.|'[\w-]+'|[:,]", span):
                part = part.strip()
                if len(part) < 4:
                    continue
                count += 1
                if part not in said:
                    yield f"deploy/README.md:{number}: no program says '{part}'"
    print(f"{count} phrases")
    if count < 30:
        yield "the tables were not found"


def heading_line(page, heading):
    return page.read_text().splitlines().index(heading)


def main():
    checks = {
        "tests": check_tests,
        "values": check_values,
        "profiles": check_profiles,
        "phrases": check_phrases,
    }
    check, root = sys.argv[1:]
    errors = list(checks[check](Path(root).resolve()))
    for error in errors:
        print(error, file=sys.stderr)
    sys.exit(1 if errors else 0)


main()
