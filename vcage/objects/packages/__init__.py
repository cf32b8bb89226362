"""Models from other projects' packages: fetched at set-up, converted, cached, and never part of this repository."""

from __future__ import annotations

from vcage.base.errors import UnknownName
from vcage.objects.packages.package import Package
from vcage.objects.packages.robosuite import ROBOSUITE
from vcage.objects.packages.sweethome3d import SWEET_HOME_3D
from vcage.objects.packages.ycb import YCB

PACKAGES: dict[str, Package] = {package.name: package for package in (SWEET_HOME_3D, ROBOSUITE, YCB)}
"""Packages by the name in an annotation's ``source``."""


def package_of(source: str) -> Package:
    """Return the package of this name.

    Raises:
        UnknownName: there is none.
    """
    if source not in PACKAGES:
        raise UnknownName("package of models", source, PACKAGES)
    return PACKAGES[source]
