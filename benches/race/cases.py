"""The models of the race."""

import dataclasses
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Models of the Standard Library, each with a stop time in s, a tolerance, and a variable without jumps.
STANDARD = [
    ("Modelica.Blocks.Examples.PID_Controller", 4, 1e-6, "inertia1.w"),
    ("Modelica.Electrical.Analog.Examples.ParallelResonance", 1, 1e-6, "capacitor1.v"),
    ("Modelica.Electrical.Machines.Examples.DCMachines.DCSE_Start", 2, 1e-7, "loadInertia.w"),
    ("Modelica.Electrical.Polyphase.Examples.Rectifier", 0.1, 1e-6, "cDC1.v"),
    ("Modelica.Electrical.Spice3.Examples.Graetz", 0.025, 1e-6, "D3.n.v"),
    ("Modelica.Magnetic.FluxTubes.Examples.MovingCoilActuator.ArmatureStroke", 0.05, 1e-8, "cActuator.x"),
    ("Modelica.Mechanics.MultiBody.Examples.Systems.RobotR3.OneAxis", 1.6, 1e-6, "axis.gear.spring.phi_rel"),
    ("Modelica.Mechanics.Rotational.Examples.CoupledClutches", 1.5, 1e-6, "J1.w"),
    ("Modelica.Mechanics.Translational.Examples.Oscillator", 1, 1e-6, "mass1.s"),
    ("Modelica.Thermal.FluidHeatFlow.Examples.TwoTanks", 1.5, 1e-6, "openTank1.m"),
]


@dataclasses.dataclass(frozen=True)
class Vary:
    """A parameter, and the values that it takes in turn."""

    name: str
    first: float
    last: float
    count: int

    def values(self):
        return [self.first + (self.last - self.first) * k / (self.count - 1) for k in range(self.count)]


def first(type_name):
    """A model with a variable of this type, for which a tool must have read the libraries."""
    return f"model First\n  {type_name} x = time;\nend First;\n"


@dataclasses.dataclass(frozen=True)
class Case:
    """A model to run to `stop`, s, with `rows` + 1 points of one variable; with `vary`, the variable's last values.

    Each library is the folder or the file of a package, and the model `First` of the text `first` uses them.
    """

    name: str
    text: str
    model: str
    stop: float
    variable: str
    libraries: tuple = ()
    first: str = first("Real")
    tolerance: float = 1e-6
    rows: int = 500
    vary: Vary | None = None


def cases(standard):
    """All cases; those of the Standard Library if its folder is given."""
    read = lambda path: (ROOT / path).read_text(encoding="utf-8")
    own = (tuple(sorted(path for path in (ROOT / "lib").iterdir() if path.is_dir())), first("Units.Time"))
    packages = standard and tuple(standard / name for name in ("Complex.mo", "ModelicaServices", "Modelica"))
    msl = (packages, first("Modelica.Units.SI.Time"))
    valve, filling = read("examples/valve52.mol"), read("examples/filling.mol")
    yield Case("VT-52", valve, "Valve52", 0.12, "s", *own)
    yield Case("five-state valve", read("benches/race/valve.mo"), "Valve", 1, "p2")
    yield Case("filling", filling, "Filling", 5, "p", *own)
    for size in (10, 100, 1000):
        text = read("benches/chain.mo") + f"\nmodel Race = Chain.Test(N = {size});\n"
        yield Case(f"chain of {size}", text, "Race", 1, "mass[1].s")
    supply = Vary("p_supply", 3e5, 9e5, 1000)
    yield Case("VT-52, 1000 runs", valve, "Valve52", 0.12, "p14", *own, vary=supply)
    conductance = Vary("line.C", 0.5e-9, 1.5e-9, 1000)
    yield Case("filling, 1000 runs", filling, "Filling", 5, "p", *own, vary=conductance)
    for model, stop, tolerance, variable in STANDARD if standard else ():
        text = f'model Race\n  extends {model};\n  annotation(uses(Modelica(version = "4.1.0")));\nend Race;\n'
        yield Case(model.removeprefix("Modelica."), text, "Race", stop, variable, *msl, tolerance)
