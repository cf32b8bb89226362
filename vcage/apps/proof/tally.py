"""Counting tries: a point or joint is proven when at most one of its tries failed."""

from __future__ import annotations

from dataclasses import dataclass, field

from vcage.schema.proof import Check, CheckName

ALLOWED_FAILURES = 1
"""Nine of ten."""


@dataclass
class Tally:
    """Tries of one point or joint.

    Args:
        tries: how many there will be.
    """

    tries: int
    succeeded: int = 0
    reasons: list[str] = field(default_factory=list)

    def add(self, reason: str | None) -> None:
        """Count a try: None for a success, or why it failed."""
        if reason is None:
            self.succeeded += 1
        elif reason not in self.reasons:
            self.reasons.append(reason)

    def check(self, name: CheckName, subject: str, measured: dict[str, float] | None = None) -> Check:
        """The tries as a record."""
        passed = self.succeeded >= max(1, self.tries - ALLOWED_FAILURES)
        return Check(
            check=name,
            subject=subject,
            passed=passed,
            tries=self.tries,
            succeeded=self.succeeded,
            measured=measured or {},
            reasons=self.reasons,
        )
