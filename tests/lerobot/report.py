"""The checks, reported line by line."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field


@dataclass
class Report:
    """Checks and the differences they found.

    Args:
        quiet: print nothing.
        checks: number of checks.
        differences: what each failed check was about → its first difference and the number of others.
    """

    quiet: bool = False
    checks: int = 0
    differences: dict[str, str] = field(default_factory=dict)

    def check(self, what: str, right: str, wrong: list[str]) -> None:
        """Tell of one check.

        Args:
            what: its subject, one line.
            right: what was found, when nothing is wrong.
            wrong: the differences; empty when there is none.
        """
        self.checks += 1
        if wrong:
            self.differences[what] = wrong[0] + (f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else "")
        self.say(f"{'DIFFERS' if wrong else 'equal  '}  {what}: {self.differences[what] if wrong else right}")

    def say(self, line: str) -> None:
        """Print, unless quiet."""
        if not self.quiet:
            print(line, flush=True)


class Tally:
    """Counts comparisons of many items by subject."""

    def __init__(self) -> None:
        self._seen: dict[str, int] = defaultdict(int)
        self._wrong: dict[str, list[str]] = defaultdict(list)

    def note(self, subject: str, equal: bool, difference: str) -> None:
        """Count one comparison; ``difference`` states the found and the expected value."""
        self._seen[subject] += 1
        if not equal:
            self._wrong[subject].append(difference)

    def tell(self, report: Report, name: str) -> None:
        """One check per subject that differs, and one for all the others."""
        for subject, differences in self._wrong.items():
            report.check(f"{name}: {subject}", "", differences)
        right = [f"{count} × {subject}" for subject, count in self._seen.items() if subject not in self._wrong]
        if right:
            report.check(name, ", ".join(right), [])
