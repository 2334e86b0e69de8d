"""Compilation: the model as data, and errors."""

import pickle

import pytest
from conftest import ROOT, TANK

import mocc


def test_a_model_tells_its_parameters_variables_and_states(tank):
    assert tank.name == "Tank"
    k = tank.parameters["k"]
    assert (k.value, k.unit, k.description, k.place) == (0.5, "1/s", "Rate", "<text>:3:18")
    assert tank.parameters["n"].value == 2 and tank.parameters["open"].value is True
    x = tank.variables["x"]
    assert (x.kind, x.unit, x.description) == ("continuous", "m", "Level")
    assert tank.states == ["x"] and tank.inputs == ["u"]
    assert "model Tank" in tank.flat and "der(x)" in tank.flat
    assert "state" in tank.structure
    assert "Tank" in repr(tank)


def test_enumerations_and_strings_are_values():
    m = mocc.compile("""
        model M
          type Gas = enumeration(air, argon);
          parameter Gas gas = Gas.argon;
          parameter String label = "tank";
          Real x = time;
        end M;
    """)
    assert m.parameters["gas"].value.endswith("argon")
    assert m.parameters["label"].value == "tank"


def test_objects_are_those_of_the_package(tank, ball):
    r = ball.simulate()
    assert isinstance(tank, mocc.Model) and isinstance(r, mocc.Result)
    assert isinstance(tank.parameters["k"], mocc.Parameter) and tank.parameters["k"].display_unit == ""
    assert isinstance(tank.variables["x"], mocc.Variable)
    assert isinstance(r.columns[0], mocc.Column) and isinstance(r.events[0], mocc.Event)
    assert isinstance(r.plot("h"), mocc.Figure)
    assert issubclass(mocc.InternalError, mocc.Error)


def test_files_libraries_and_settings(tmp_path):
    (tmp_path / "Parts.mo").write_text("package Parts model P parameter Real a = 1; Real x = a*time; end P; end Parts;")
    m = mocc.compile(model="Parts.P", set={"a": 3}, lib=[tmp_path])
    assert m.simulate()["x"][-1] == 3.0
    assert mocc.compile(str(ROOT / "examples" / "bouncing_ball.mol")).states


def test_the_valve_is_the_one_of_the_command(valve):
    assert valve.name == "Valve52"
    assert valve.parameters["p_supply"].unit == "Pa"
    assert "valve52.mol:" in valve.parameters["p_supply"].place


def test_a_wrong_model_is_one_exception_with_an_excerpt():
    with pytest.raises(mocc.ModelError) as caught:
        mocc.compile("model M\n  Real x = y;\nend M;")
    error = caught.value
    assert error.code.startswith("MO02")
    assert error.place == "<text>:2:12"
    assert "Real x = y" in error.rendered and "Real x = y" in str(error)
    problem = error.problems[0]
    assert isinstance(problem, mocc.Problem) and problem.message == error.message
    assert problem.notes[0].startswith("see section") and problem.time is None
    assert isinstance(pickle.loads(pickle.dumps(error)), mocc.ModelError)


def test_all_errors_are_reported_at_once():
    with pytest.raises(mocc.ModelError) as caught:
        mocc.compile("model M\n  Real x = y;\n  Real z = w;\nend M;")
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"path_or_text": "no_such_file.mol"}, "no_such_file.mol"),
        ({}, "neither a file nor a model"),
        ({"path_or_text": TANK, "set": {"kk": 1}}, "kk"),
        ({"path_or_text": TANK, "set": {"k": float("nan")}}, "not a finite number"),
        ({"path_or_text": TANK, "set": {"k": object()}}, "give a number"),
        ({"path_or_text": TANK, "lib": "no_such_folder"}, "no_such_folder"),
    ],
)
def test_a_wrong_request_is_a_value_error(arguments, text):
    with pytest.raises(mocc.RequestError, match=text) as caught:
        mocc.compile(**arguments)
    assert isinstance(caught.value, ValueError)


def test_a_name_gets_help():
    with pytest.raises(mocc.Error) as caught:
        mocc.compile(TANK, model="Tnak")
    assert "Tank" in caught.value.help


def test_warnings_of_the_compiler_are_warnings():
    text = """
        model M
          Real p(unit = "Pa") = 1;
          Real s(unit = "m") = p;
        end M;
    """
    with pytest.warns(mocc.ModelWarning, match="MO0320"):
        mocc.compile(text)


def test_a_model_pickles_as_its_source(tmp_path):
    file = tmp_path / "tank.mol"
    file.write_text(TANK)
    m = mocc.compile(file, set={"k": 1})
    # The compiled text counts, whatever becomes of the file.
    file.unlink()
    again = pickle.loads(pickle.dumps(m))
    assert again.parameters["k"].value == 1
    assert (again.simulate()["x"] == m.simulate()["x"]).all()


NAMED = 'model Named parameter String name = "abc"; parameter Integer n = 1; Real x = time; end Named;'


@pytest.mark.parametrize("value", ["xyz", "two words", 'a "quote"', "back\\slash", "n"])
def test_strings_are_values_of_string_parameters(value):
    model = mocc.compile(NAMED, set={"name": value, "n": 3}) if value != "n" else mocc.compile(NAMED)
    if value != "n":
        assert model.parameters["name"].value == value and model.parameters["n"].value == 3
    assert mocc.compile(NAMED, set={"name": '"quoted"'}).parameters["name"].value == "quoted"
    # A run takes it, too.
    model.simulate(set={"name": value})


def test_wrong_sources_are_one_clear_exception():
    with pytest.raises(mocc.RequestError, match="`path_or_text` is a int"):
        mocc.compile(3)
    with pytest.raises(mocc.RequestError, match="compiled model"):
        mocc.compile(mocc.compile(NAMED))
    with pytest.raises(mocc.RequestError, match="xyz"):
        mocc.compile(NAMED, set={"n": "xyz"})
