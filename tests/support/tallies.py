"""What a suite's result file says, as numbers."""

import re
import xml.etree.ElementTree as xml
from dataclasses import dataclass, field


@dataclass
class Tally:
    passed: int = 0
    failed: int = 0
    skipped: int = 0
    names: list = field(default_factory=list)  # of what failed
    seconds: float = 0.0

    @property
    def ran(self) -> bool:
        return self.passed + self.failed > 0

    def __add__(self, other):
        return Tally(self.passed + other.passed, self.failed + other.failed,
                     self.skipped + other.skipped, self.names + other.names)


def from_junit(path, exit_code) -> Tally:
    """Counts the cases of a JUnit file. A program that failed although no case did (a crash
    after the last one, a collection error) is one failure more."""
    try:
        cases = cases_of(path)
    except (OSError, xml.ParseError) as error:
        return Tally(failed=1, names=[f"exit code {exit_code}, no readable result file: {error}"])
    return from_cases(cases, exit_code)


def from_ctest(path, exit_code, wholes) -> Tally:
    """As from_junit, where a program that is one entry of ctest's counts by its own cases, which
    it left in the folder `wholes`. One that left none (it crashed) is one failure."""
    try:
        cases = [part for case in cases_of(path) for part in parts_of(case, wholes)]
    except (OSError, xml.ParseError) as error:
        return Tally(failed=1, names=[f"exit code {exit_code}, no readable result file: {error}"])
    return from_cases(cases, exit_code)


def cases_of(path) -> list:
    return list(xml.parse(path).getroot().iter("testcase"))


def parts_of(case, wholes) -> list:
    file = wholes / f"{case.get('name')}.xml"
    if not file.exists():
        return [case]
    parts = cases_of(file)
    for part in parts:
        part.set("name", f"{file.stem}.{part.get('classname')}.{part.get('name')}")
    failed = any(part.find("failure") is not None for part in parts)
    # The entry itself stays when it failed for a reason that no case has: a leak at the end, say.
    return parts if failed or case.get("status") == "run" else [*parts, case]


def from_cases(cases, exit_code) -> Tally:
    tally = Tally()
    for case in cases:
        # ctest calls a test it could not run "disabled" or "notrun": neither is a pass.
        if case.find("failure") is not None or case.find("error") is not None or \
                case.get("status") in ("fail", "disabled", "notrun"):
            if case.find("skipped") is not None and case.get("status") == "notrun" and \
                    "SKIP" in (case.find("skipped").get("message") or "").upper():
                tally.skipped += 1
                continue
            tally.failed += 1
            tally.names.append(case.get("name") or "(no name)")
        elif case.find("skipped") is not None:
            tally.skipped += 1
        else:
            tally.passed += 1
    if exit_code != 0 and tally.failed == 0:
        tally.failed += 1
        tally.names.append(f"exit code {exit_code} although every case passed")
    return tally


def from_last_line(log, exit_code) -> Tally:
    """Reads "N passed, N failed" from the end of a log."""
    found = re.findall(r"^(\d+) passed, (\d+) failed$", log.read_text(errors="replace"), re.M)
    if not found:
        return Tally(failed=1, names=[f"exit code {exit_code}, no summary in {log.name}"])
    passed, failed = map(int, found[-1])
    if exit_code != 0 and failed == 0:
        failed = 1
    return Tally(passed, failed, names=[f"see {log.name}"] if failed else [])
