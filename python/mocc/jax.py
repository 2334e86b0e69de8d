"""Runs and residuals as functions of JAX, differentiated by the engine's exact sensitivities.

    import jax, mocc.jax
    jax.config.update("jax_enable_x64", True)

    f = mocc.jax.run(m, ["k"], ["x"], times)
    jax.jacobian(f)(jnp.array([0.5]))

Functions take a vector of parameters, may be compiled by `jax.jit`, and have first derivatives in forward and reverse mode.
They compute on the host in 64 bits; without `jax_enable_x64` their results are rounded to 32 bits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from mocc._model import Model
from mocc._study import Calibration


def run(model: Model, parameters: Iterable[str], variables: Iterable[str], times: Any, **keys: Any) -> Callable[[Any], Any]:
    """The run of a model as a function: of values of `parameters`, shape `(parameters,)`, SI, it makes the values of
    `variables` at `times`, s, shape `(times, variables)`, SI. `keys` are those of `Model.sensitivities`.

    Errors, when the function is called: as for `Model.sensitivities`, which JAX wraps.
    """
    by, of, instants = list(parameters), list(variables), np.asarray(times, dtype=float)
    fixed = dict(keys.pop("set", None) or {})

    def both(theta: Any) -> tuple[Any, Any]:
        at = dict(zip(by, np.asarray(theta, dtype=float).tolist(), strict=True))
        return model.sensitivities(by, of, instants, set={**fixed, **at}, **keys)

    return _function(both, (len(instants), len(of)))


def residuals(calibration: Calibration) -> Callable[[Any], Any]:
    """`Calibration.residuals` as a function: of values in the order of `names` it makes the residuals, shape `(m,)`."""

    def both(theta: Any) -> tuple[Any, Any]:
        return calibration.residuals(np.asarray(theta)), calibration.jacobian(np.asarray(theta))

    return _function(both, calibration.residuals().shape)


def _function(both: Callable[[Any], tuple[Any, Any]], shape: tuple[int, ...]) -> Callable[[Any], Any]:
    def call(theta: Any) -> tuple[Any, Any]:
        dtype = jnp.result_type(theta, float)
        struct: Any = jax.ShapeDtypeStruct
        outputs = (struct(shape, dtype), struct((*shape, *theta.shape), dtype))

        def host(x: Any) -> tuple[Any, Any]:
            values, slopes = both(x)
            return np.asarray(values, dtype=dtype), np.asarray(slopes, dtype=dtype)

        return jax.pure_callback(host, outputs, theta, vmap_method="sequential")  # type: ignore[no-any-return]

    @jax.custom_jvp  # type: ignore[untyped-decorator,unused-ignore]
    def f(theta: Any) -> Any:
        return call(jnp.asarray(theta, dtype=float))[0]

    @f.defjvp  # type: ignore[untyped-decorator,unused-ignore]
    def jvp(primals: tuple[Any], tangents: tuple[Any]) -> tuple[Any, Any]:
        values, slopes = call(jnp.asarray(primals[0], dtype=float))
        return values, slopes @ tangents[0]

    return f  # type: ignore[no-any-return,unused-ignore]
