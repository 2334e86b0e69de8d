"""A stand-in for torch, of which `mocc.torch` needs little: it tests our side where torch, some gigabytes, is not installed.

Tensors over NumPy that remember how they were made, for first derivatives of sums of squares.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

float64 = np.dtype(np.float64)


class Tensor:
    def __init__(self, data: Any, requires_grad: bool = False, back: Any = None) -> None:
        self.data = np.asarray(data)
        self.requires_grad = requires_grad
        self.grad: Any = None
        self._back = back

    dtype = property(lambda self: self.data.dtype)
    shape = property(lambda self: self.data.shape)

    def detach(self) -> Tensor:
        return Tensor(self.data)

    def numpy(self) -> Any:
        assert not self.requires_grad, "detach it first, as torch demands"
        return self.data

    def to(self, dtype: Any) -> Tensor:
        return Tensor(self.data.astype(dtype))

    def reshape(self, *shape: int) -> Tensor:
        return Tensor(self.data.reshape(*shape))

    def __matmul__(self, other: Tensor) -> Tensor:
        return Tensor(self.data @ other.data)

    def square(self) -> Tensor:
        return Tensor(self.data**2, back=lambda g: self._receive(2 * self.data * g))

    def sum(self) -> Tensor:
        return Tensor(self.data.sum(), back=lambda g: self._receive(g * np.ones(self.data.shape)))

    def backward(self) -> None:
        self._back(1.0)

    def _receive(self, gradient: Any) -> None:
        if self.requires_grad:
            self.grad = gradient
        elif self._back is not None:
            self._back(gradient)


class _Context:
    saved_tensors: tuple[Tensor, ...]

    def save_for_backward(self, *tensors: Tensor) -> None:
        self.saved_tensors = tensors


class _Function:
    @classmethod
    def apply(cls, *arguments: Any) -> Tensor:
        context = _Context()
        made = cls.forward(context, *arguments)  # type: ignore[attr-defined]

        def back(gradient: Any) -> None:
            passed = cls.backward(context, Tensor(gradient))  # type: ignore[attr-defined]
            assert len(passed) == len(arguments)
            arguments[0]._receive(passed[0].data)

        return Tensor(made.data, back=back)


autograd = SimpleNamespace(Function=_Function)


def tensor(data: Any, dtype: Any = float64, requires_grad: bool = False) -> Tensor:
    return Tensor(np.array(data, dtype=dtype), requires_grad)


def from_numpy(data: Any) -> Tensor:
    return Tensor(data)
