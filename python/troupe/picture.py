"""Picture: the bytes of a picture, which a notebook shows; and Page, the page of a simulation in a cell.

A picture is a `bytes`, so that it can be written, sent and compared like any; equal states give equal bytes.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Optional, Union

if TYPE_CHECKING:
    import numpy


class Picture(bytes):
    """The bytes of a PNG or SVG file."""

    @property
    def format(self) -> str:
        """ "png" or "svg"."""
        return "png" if self.startswith(b"\x89PNG") else "svg"

    def array(self) -> "numpy.ndarray[Any, Any]":
        """The pixels of a PNG file, uint8 (height, width, 3 or 4), for videos and figures. ValueError for an SVG file."""
        from ._troupe import pixels
        if self.format != "png":
            raise ValueError("found an SVG file, expected a PNG file")
        return pixels(bytes(self))

    def save(self, file: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the file. OSError if it cannot be written."""
        with open(file, "wb") as out:
            out.write(self)

    def _repr_png_(self) -> Optional[bytes]:
        return bytes(self) if self.format == "png" else None

    def _repr_svg_(self) -> Optional[str]:
        return self.decode() if self.format == "svg" else None


class Page:
    """The page of a simulation (`Simulation.view`) in the cell of a notebook."""

    def __init__(self, address: str, height: int) -> None:
        self.address = address
        self.height = height

    def _repr_html_(self) -> str:
        from html import escape
        return (f'<iframe src="{escape(self.address)}" width="100%" height="{self.height}" style="border: 1px solid #ccc" '
                'title="The simulation"></iframe>')

    def __repr__(self) -> str:
        return f"<troupe.Page {self.address}>"
