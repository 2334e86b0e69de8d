"""Steady states, linear systems and derivatives of runs, against closed forms."""

import math
import sys

import numpy as np
import pytest
from conftest import BALL, PLAN, TANK, recording

import mocc

MOTOR = """
model Motor "A motor with a constant field"
  parameter Real R(unit = "Ohm") = 2;
  parameter Real L(unit = "H") = 0.01;
  parameter Real k(unit = "N.m/A") = 0.05;
  parameter Real J(unit = "kg.m2") = 1e-4;
  parameter Real d(unit = "N.m.s/rad") = 1e-5;
  input Real v(unit = "V", start = 1);
  output Real rpm = w*30/3.14159265358979;
  Real i(unit = "A", start = 0, fixed = true);
  Real w(unit = "rad/s", start = 0, fixed = true);
equation
  L*der(i) = v - R*i - k*w;
  J*der(w) = k*i - d*w;
end Motor;
"""


@pytest.fixture(scope="module")
def motor() -> mocc.Model:
    return mocc.compile(MOTOR)


def test_a_linear_model_is_its_own_linear_system(motor):
    system = motor.linearize()
    assert isinstance(system, mocc.Linearization)
    a, b, c, d = system
    assert (system.states, system.inputs, system.outputs) == (["i", "w"], ["v"], ["rpm"])
    assert np.allclose(a, [[-200, -5], [500, -0.1]], rtol=1e-14)
    assert np.allclose(b, [[100], [0]]) and (d == 0).all()
    assert np.allclose(c, [[0, 30 / math.pi]])
    assert np.allclose(sorted(system.eigenvalues), sorted(np.linalg.eigvals(a)), rtol=1e-10)
    assert system.time == 0 and system.x.tolist() == [0, 0] and system.u.tolist() == [1]
    assert system.dx.tolist() == [100, 0] and system.y.tolist() == [0]
    assert system.units == {"i": "A", "w": "rad/s", "v": "V", "rpm": ""}
    assert "2 states" in repr(system) and "<table>" in system._repr_html_() and system.name == "Motor"
    values, right = np.linalg.eig(a)
    parts = np.abs(right * np.linalg.inv(right).T)[:, np.argsort(-values.real)].T
    assert np.allclose(system.participation, parts / parts.sum(axis=1, keepdims=True), rtol=1e-9)


def test_other_packages_take_it(motor):
    scipy = pytest.importorskip("scipy.signal")
    system = motor.linearize(at="steady", outputs=["w"])
    t, y = scipy.step(system.to_scipy(), T=np.linspace(0, 2, 50))
    run = motor.simulate(2, inputs={"v": ([0], [1.0])}, tolerance=1e-9, interval=1e-4)
    assert np.allclose(y, np.interp(t, run.time, run["w"]), atol=1e-3)
    control = pytest.importorskip("control")
    assert np.allclose(control.poles(system.to_control()), np.linalg.eigvals(system.A))


def test_a_steady_state_is_where_the_run_ends(motor):
    for solve in (False, True):
        rest = motor.steady_state(inputs={"v": 12}, solve=solve)
        assert isinstance(rest, mocc.SteadyState)
        w = 12 / (2 * 1e-5 / 0.05 + 0.05)
        assert rest.states["w"] == pytest.approx(w, rel=1e-10) and rest["w"] == rest.states["w"]
        assert rest.outputs["rpm"] == pytest.approx(w * 30 / math.pi, rel=1e-10)
        assert rest.inputs == {"v": 12} and rest.is_stable and rest.units["w"] == "rad/s"
        assert rest.eigenvalues.shape == (2,) and "rpm" in rest.keys() and "i" in rest
        assert "Motor" in repr(rest) and "<table>" in rest._repr_html_() and rest.name == "Motor"
    assert motor.steady_state(inputs={"v": 12}).time >= 1
    with pytest.raises(KeyError, match="did you mean `rpm`"):
        rest["rpms"]


def test_points_are_instants_states_and_steady_states(motor):
    pendulum = mocc.compile("""
        model Pendulum
          Real phi(start = 3, fixed = true);
          Real w(start = 0, fixed = true);
        equation
          der(phi) = w;
          der(w) = -9*sin(phi) - 0.4*w;
        end Pendulum;
    """)
    upright = pendulum.steady_state(solve=True)
    assert upright.states["phi"] == pytest.approx(math.pi, abs=1e-9) and not upright.is_stable
    assert pendulum.linearize(at=upright).A[1, 0] == pytest.approx(9)
    assert pendulum.linearize(at={"phi": 0.5}).A[1, 0] == pytest.approx(-9 * math.cos(0.5), rel=1e-14)
    assert pendulum.linearize(at="steady").A[1, 0] == pytest.approx(-9)
    later = pendulum.linearize(at=1.25)
    assert later.time == 1.25 and later.A[1, 0] == pytest.approx(-9 * math.cos(later.x[0]), rel=1e-14)
    run = pendulum.simulate(1.25)
    assert later.x.tolist() == [run["phi"][-1], run["w"][-1]]


def test_settings_reach_the_point(motor):
    assert motor.linearize(set={"R": 4}).A[0, 0] == pytest.approx(-400)
    rest = motor.steady_state(set={"R": 4}, inputs={"v": 3}, tolerance=1e-8)
    assert motor.linearize(at=rest).A[0, 0] == pytest.approx(-400)
    tank = mocc.compile(TANK)
    assert tank.steady_state(set={"open": False}, inputs={"u": 0}).states["x"] == 2
    assert tank.linearize(set={"n": 4}).A[0, 0] == -1


def test_what_has_no_point_says_so(motor):
    with pytest.raises(mocc.SimulationError) as caught:
        mocc.compile(BALL).steady_state(set={"e": 1.0})
    assert caught.value.code in ("MO0937", "MO0912", "MO0911", "MO0910"), caught.value
    for wrong in (
        lambda: motor.steady_state(inputs={"u": 1}),
        lambda: motor.steady_state(inputs={"v": math.nan}),
        lambda: motor.linearize(at="rest"),
        lambda: motor.linearize(at={"x": 1}),
        lambda: motor.linearize(outputs=["nothing"]),
    ):
        with pytest.raises(mocc.RequestError):
            wrong()


def test_derivatives_of_runs_are_those_of_the_closed_form(tank):
    times = np.linspace(0, 4, 9)
    values, slopes = tank.sensitivities(["k", "x.start", "x_0"], ["y", "x"], times, set={"k": 0.7})
    assert values.shape == (9, 2) and slopes.shape == (9, 2, 3)
    x = 2 * np.exp(-0.7 * times)
    assert np.allclose(values[:, 1], x, rtol=1e-5) and np.allclose(values[:, 0], 2 * x, rtol=1e-5)
    assert np.allclose(slopes[:, 1, 0], -times * x, atol=1e-5)
    assert np.allclose(slopes[:, 1, 1], np.exp(-0.7 * times), atol=1e-5)


def test_derivatives_cross_events(ball):
    # The first bounce is at sqrt(2/g); after it the speed is that of the share e.
    times = [0.6]
    values, slopes = ball.sensitivities(["e"], ["h", "v"], times, tolerance=1e-9)
    fall = math.sqrt(2 / 9.81)
    after = 0.6 - fall
    assert values[0, 0] == pytest.approx(0.8 * 9.81 * fall * after - 9.81 / 2 * after**2, rel=1e-6)
    assert slopes[0, 0, 0] == pytest.approx(9.81 * fall * after, rel=1e-6)


def test_derivatives_refuse_what_has_none(tank):
    for wrong in (
        lambda: tank.sensitivities(["n"], ["x"], [1.0]),
        lambda: tank.sensitivities(["k"], ["nothing"], [1.0]),
        lambda: tank.sensitivities(["k"], ["x"], [-1.0, 1.0]),
        lambda: tank.sensitivities(["k"], ["x"], [1.0, 1.0]),
        lambda: tank.sensitivities([], ["x"], [1.0]),
    ):
        with pytest.raises(mocc.RequestError):
            wrong()


def test_jax_differentiates_runs_and_residuals(tank):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import mocc.jax

    times = np.linspace(0.5, 4, 8)
    f = mocc.jax.run(tank, ["k", "x_0"], ["x"], times)
    theta = jax.numpy.array([0.7, 2.0])
    values, slopes = tank.sensitivities(["k", "x_0"], ["x"], times, set={"k": 0.7, "x_0": 2.0})
    assert (np.asarray(f(theta)) == values).all()
    for jacobian in (jax.jacfwd(f), jax.jacrev(f), jax.jit(jax.jacrev(f))):
        assert np.allclose(jacobian(theta), slopes, rtol=1e-12)
    c = mocc.calibrate(PLAN, {"one": recording(0.8, 1)})
    r = mocc.jax.residuals(c)
    assert (np.asarray(r(theta)) == c.residuals([0.7, 2.0])).all()
    assert np.allclose(jax.jacrev(r)(theta), c.jacobian([0.7, 2.0]), rtol=1e-12)


@pytest.fixture
def torch(monkeypatch):
    try:
        import torch as found
    except ImportError:
        import torch_stand_in as found

        monkeypatch.setitem(sys.modules, "torch", found)
    yield found
    sys.modules.pop("mocc.torch", None)


def test_torch_differentiates_runs_and_residuals(tank, torch):
    import mocc.torch

    times = np.linspace(0.5, 4, 8)
    f = mocc.torch.run(tank, ["k", "x_0"], ["x"], times)
    theta = torch.tensor([0.7, 2.0], dtype=torch.float64, requires_grad=True)
    f(theta).square().sum().backward()
    values, slopes = tank.sensitivities(["k", "x_0"], ["x"], times, set={"k": 0.7, "x_0": 2.0})
    assert np.allclose(theta.grad, 2 * np.einsum("tv,tvp->p", values, slopes), rtol=1e-12)
    c = mocc.calibrate(PLAN, {"one": recording(0.8, 1)})
    theta = torch.tensor([0.7, 2.0], dtype=torch.float64, requires_grad=True)
    mocc.torch.residuals(c)(theta).square().sum().backward()
    at = [0.7, 2.0]
    assert np.allclose(theta.grad, 2 * c.jacobian(at).T @ c.residuals(at), rtol=1e-12)
