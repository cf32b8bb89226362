"""Read hosts and headers of HTTP."""

from __future__ import annotations

import ipaddress
import time
from email.utils import parsedate_to_datetime


def is_loopback(host: str) -> bool:
    """Check if a host is this machine."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def retry_after(value: str | None) -> float | None:
    """Seconds that the endpoint asks to wait; it says so as a number or as a date."""
    if value is None:
        return None
    try:
        return max(0.0, float(value))
    except ValueError:
        pass
    try:
        return max(0.0, parsedate_to_datetime(value).timestamp() - time.time())
    except (TypeError, ValueError):
        return None
