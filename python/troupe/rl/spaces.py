"""Spaces: Gymnasium's Box and Discrete, if that is installed, else what environments and learners use of them."""

from __future__ import annotations

from typing import Any, Optional, Sequence

import numpy
from numpy.typing import NDArray

Array = NDArray[Any]


class _Box:
    """Arrays of a shape, each number between two bounds."""

    def __init__(self, low: Any, high: Any, shape: Optional[Sequence[int]] = None, dtype: Any = numpy.float32,
                 seed: Optional[int] = None) -> None:
        self.dtype = numpy.dtype(dtype)
        self.shape = tuple(shape) if shape is not None else numpy.shape(low)
        self.low = numpy.broadcast_to(numpy.asarray(low, self.dtype), self.shape)
        self.high = numpy.broadcast_to(numpy.asarray(high, self.dtype), self.shape)
        self.seed(seed)

    def seed(self, seed: Optional[int] = None) -> None:
        self._generator = numpy.random.default_rng(seed)

    def sample(self) -> Array:
        low, high = numpy.clip(self.low, -1e6, 1e6), numpy.clip(self.high, -1e6, 1e6)
        return self._generator.uniform(low, high, self.shape).astype(self.dtype)

    def contains(self, value: Any) -> bool:
        value = numpy.asarray(value)
        return value.shape == self.shape and bool(((value >= self.low) & (value <= self.high)).all())

    def __contains__(self, value: Any) -> bool:
        return self.contains(value)

    def __eq__(self, other: Any) -> bool:
        return (isinstance(other, _Box) and self.shape == other.shape and self.dtype == other.dtype
                and bool((self.low == other.low).all() and (self.high == other.high).all()))

    def __repr__(self) -> str:
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"


class _Discrete:
    """Whole numbers from 0 to n - 1."""

    def __init__(self, n: int, seed: Optional[int] = None) -> None:
        self.n = n
        self.dtype = numpy.dtype(numpy.int64)
        self.shape: Sequence[int] = ()
        self.seed(seed)

    def seed(self, seed: Optional[int] = None) -> None:
        self._generator = numpy.random.default_rng(seed)

    def sample(self) -> numpy.int64:
        return numpy.int64(self._generator.integers(self.n))

    def contains(self, value: Any) -> bool:
        array = numpy.asarray(value)
        return array.shape == () and array.dtype.kind in "iu" and 0 <= int(array) < self.n

    def __contains__(self, value: Any) -> bool:
        return self.contains(value)

    def __eq__(self, other: Any) -> bool:
        return isinstance(other, _Discrete) and self.n == other.n

    def __repr__(self) -> str:
        return f"Discrete({self.n})"


def Discrete(n: int) -> Any:
    """gymnasium.spaces.Discrete, or the like."""
    try:
        from gymnasium.spaces import Discrete as GymnasiumDiscrete
    except ImportError:
        return _Discrete(n)
    return GymnasiumDiscrete(n)


def Box(low: Any, high: Any, shape: Sequence[int], dtype: Any = numpy.float32) -> Any:
    """gymnasium.spaces.Box, or the like."""
    try:
        from gymnasium.spaces import Box as GymnasiumBox
    except ImportError:
        return _Box(low, high, shape, dtype)
    return GymnasiumBox(low, high, tuple(shape), dtype)
