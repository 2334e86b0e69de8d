"""Runs and residuals as functions of torch, differentiated by the engine's exact sensitivities.

    import torch, mocc.torch

    f = mocc.torch.run(m, ["k"], ["x"], times)
    k = torch.tensor([0.5], dtype=torch.float64, requires_grad=True)
    f(k).square().sum().backward()

Functions take a vector of parameters on the CPU, and have first derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import torch

from mocc._model import Model
from mocc._study import Calibration


def run(model: Model, parameters: Iterable[str], variables: Iterable[str], times: Any, **keys: Any) -> Callable[[Any], Any]:
    """The run of a model as a function: of values of `parameters`, shape `(parameters,)`, SI, it makes the values of
    `variables` at `times`, s, shape `(times, variables)`, SI. `keys` are those of `Model.sensitivities`.

    Errors, when the function is called: as for `Model.sensitivities`.
    """
    by, of, instants = list(parameters), list(variables), np.asarray(times, dtype=float)
    fixed = dict(keys.pop("set", None) or {})

    def both(theta: Any) -> tuple[Any, Any]:
        at = dict(zip(by, theta.tolist(), strict=True))
        return model.sensitivities(by, of, instants, set={**fixed, **at}, **keys)

    return _function(both)


def residuals(calibration: Calibration) -> Callable[[Any], Any]:
    """`Calibration.residuals` as a function: of values in the order of `names` it makes the residuals, shape `(m,)`."""
    return _function(lambda theta: (calibration.residuals(theta), calibration.jacobian(theta)))


class _Function(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    @staticmethod
    def forward(ctx: Any, theta: Any, both: Callable[[Any], tuple[Any, Any]]) -> Any:
        values, slopes = (np.array(part) for part in both(theta.detach().numpy().astype(float)))
        ctx.save_for_backward(torch.from_numpy(slopes).to(theta.dtype))
        return torch.from_numpy(values).to(theta.dtype)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> tuple[Any, None]:
        (slopes,) = ctx.saved_tensors
        n = slopes.shape[-1]
        return gradients[0].reshape(-1) @ slopes.reshape(-1, n), None


def _function(both: Callable[[Any], tuple[Any, Any]]) -> Callable[[Any], Any]:
    return lambda theta: _Function.apply(theta, both)
