//! Textbook systems: states, numbers of differentiations and kinds of blocks are known.

use super::{determined, structure};
use crate::base::diag::Problems;
use crate::base::index::FastSet;
use crate::base::render::{Style, render_all};
use crate::ir::blocks::{Assignment, Block, Blocks};
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::{Binary, ExprId, Node, VarId};
use crate::lower::fixture::model;
use crate::lower::lower;
use crate::symbolic::print;

fn sorted(text: &str) -> Blocks {
    let (flat, sources) = model(text);
    let mut problems = Problems::new();
    let blocks = lower(flat, &mut problems).and_then(|dae| structure(dae, &mut problems));
    let blocks =
        blocks.unwrap_or_else(|| panic!("{}", render_all(&problems, &sources, Style::Plain)));
    verify(&blocks);
    blocks
}

/// The rendered problems of a model, with their codes.
fn problems(text: &str) -> (Vec<&'static str>, String) {
    let (flat, sources) = model(text);
    let mut problems = Problems::new();
    let blocks = lower(flat, &mut problems).and_then(|dae| structure(dae, &mut problems));
    assert!(blocks.is_none() || !problems.is_empty());
    let codes = problems.sorted().iter().map(|d| d.code).collect();
    (codes, render_all(&problems, &sources, Style::Plain))
}

/// Every block reads only what is known before it, and every unknown is determined once.
fn verify(blocks: &Blocks) {
    let dae = &blocks.dae;
    let always = |v: &VarId| {
        let kind = dae.variables[*v].kind;
        matches!(kind, VariableKind::Parameter | VariableKind::Input)
            || dae.samples.iter().any(|s| s.flag == *v)
    };
    let continuous = |v: &VarId| {
        matches!(
            dae.variables[*v].kind,
            VariableKind::Algebraic | VariableKind::Differentiated { .. }
        )
    };
    let discrete: FastSet<VarId> = dae.discrete.iter().map(|d| d.variable).collect();
    let initial_parameter = |v: &VarId| dae.variables[*v].kind == VariableKind::InitialParameter;
    let states: FastSet<VarId> = blocks.states.iter().map(|s| s.variable).collect();
    // Initialization precedes the dynamic selection of states.
    let of_sets = blocks.state_sets.iter().flat_map(|set| &set.states);
    let selected: FastSet<VarId> = (of_sets.copied())
        .flat_map(|v| match dae.variables[v].kind {
            VariableKind::Differentiated { derivative } => [v, derivative],
            _ => [v, v],
        })
        .collect();
    for (sequence, is_known, is_unknown) in [
        (
            &blocks.continuous,
            &(|v: &VarId| states.contains(v) || discrete.contains(v) || initial_parameter(v))
                as &dyn Fn(&VarId) -> bool,
            &(|v: &VarId| continuous(v)) as &dyn Fn(&VarId) -> bool,
        ),
        (&blocks.event, &|v: &VarId| states.contains(v) || initial_parameter(v), &|v: &VarId| {
            continuous(v) || discrete.contains(v)
        }),
        (&blocks.initial, &|v: &VarId| selected.contains(v), &|v: &VarId| {
            continuous(v) || discrete.contains(v) || initial_parameter(v)
        }),
    ] {
        let mut known: FastSet<VarId> =
            dae.variables.ids().filter(|v| always(v) || is_known(v)).collect();
        let wanted = dae.variables.ids().filter(|v| is_unknown(v) && !known.contains(v)).count();
        assert_eq!(determined(sequence).len(), wanted);
        for block in sequence {
            follow(dae, block, &mut known);
        }
    }
}

fn follow(dae: &Dae, block: &Block, known: &mut FastSet<VarId>) {
    let assign = |a: &Assignment, known: &mut FastSet<VarId>| {
        read(dae, a.value, known);
        assert!(known.insert(a.variable), "{} twice", dae.variables[a.variable].name);
    };
    match block {
        Block::Assign(a) => assign(a, known),
        Block::Torn(t) => {
            assert_eq!(t.unknowns.len(), t.residuals.len());
            known.extend(&t.unknowns);
            t.explicit.iter().for_each(|a| assign(a, known));
            t.residuals.iter().for_each(|r| read(dae, r.value, known));
        }
        Block::Mixed(parts) => {
            // The continuous part sees the discrete variables of the iteration before.
            let all = determined(parts);
            let discrete = |v: &&VarId| dae.variables[**v].kind == VariableKind::Discrete;
            let mut inside = known.clone();
            inside.extend(all.iter().filter(discrete));
            for part in parts {
                match part {
                    Block::Assign(a)
                        if dae.variables[a.variable].kind == VariableKind::Discrete =>
                    {
                        read(dae, a.value, &inside);
                    }
                    other => follow(dae, other, &mut inside),
                }
            }
            known.extend(all);
        }
    }
}

fn read(dae: &Dae, e: ExprId, known: &FastSet<VarId>) {
    for v in dae.graph.variables(e) {
        assert!(known.contains(&v), "{} is not known", dae.variables[v].name);
    }
}

fn names(dae: &Dae, variables: &[VarId]) -> Vec<String> {
    variables.iter().map(|v| dae.variables[*v].name.clone()).collect()
}

fn states(blocks: &Blocks) -> Vec<String> {
    let states: Vec<VarId> = blocks.states.iter().map(|s| s.variable).collect();
    names(&blocks.dae, &states)
}

/// The number of differentiations of each equation of the model.
fn differentiations(dae: &Dae) -> Vec<usize> {
    let mut times = vec![0; dae.equations.len()];
    for (id, e) in dae.equations.enumerate() {
        let mut first = id;
        while let Some(of) = dae.equations[first].derivative_of {
            first = of;
        }
        times[first.0 as usize] += usize::from(e.derivative_of.is_some());
    }
    let originals = dae.equations.iter().filter(|e| e.derivative_of.is_none()).count();
    times.truncate(originals);
    times
}

/// `a` for an assignment, `l2` or `n2` for a linear or nonlinear system of 2 torn unknowns, `m` for
/// a mixed block.
fn kinds(sequence: &[Block]) -> String {
    let kind = |block: &Block| match block {
        Block::Assign(_) => "a".to_string(),
        Block::Torn(t) => format!("{}{}", if t.linear { "l" } else { "n" }, t.unknowns.len()),
        Block::Mixed(_) => "m".to_string(),
    };
    sequence.iter().map(kind).collect::<Vec<_>>().join(" ")
}

fn assignments(dae: &Dae, sequence: &[Block]) -> Vec<String> {
    let shown = |e| print::print(&dae.graph, e, &|v| dae.variables[v].name.clone());
    let text = |a: &Assignment| format!("{} := {}", dae.variables[a.variable].name, shown(a.value));
    let mut list = Vec::new();
    for block in sequence {
        match block {
            Block::Assign(a) => list.push(text(a)),
            Block::Torn(t) => list.extend(t.explicit.iter().map(text)),
            Block::Mixed(_) => {}
        }
    }
    list
}

const RC: &str = "parameter Real R = 10;
parameter Real C = 0.1;
Real V.p.v;
Real V.n.v;
Real V.i;
Real R1.p.v;
Real R1.n.v;
Real R1.v;
Real R1.i;
Real C1.p.v;
Real C1.n.v;
Real C1.v(start = 0, fixed = true);
Real C1.i;
Real G.v;
equation
V.p.v - V.n.v = sin(time);
R1.v = R1.p.v - R1.n.v;
R1.v = R * R1.i;
C1.v = C1.p.v - C1.n.v;
C1.i = C * der(C1.v);
G.v = 0;
V.p.v = R1.p.v;
R1.n.v = C1.p.v;
C1.n.v = V.n.v;
V.n.v = G.v;
V.i + R1.i = 0;
C1.i = R1.i;
";

#[test]
fn rc_circuit_is_a_chain_of_assignments() {
    let blocks = sorted(RC);
    assert_eq!(states(&blocks), ["C1.v"]);
    assert_eq!(differentiations(&blocks.dae).iter().sum::<usize>(), 0);
    assert!(blocks.continuous.iter().all(|b| matches!(b, Block::Assign(_))));
    assert!(blocks.assumed_starts.is_empty());
    // C dv/dt = (u - v) / R
    let list = assignments(&blocks.dae, &blocks.continuous);
    assert_eq!(list.last().map(String::as_str), Some("der(C1.v) := (-V.i) / C"), "{list:?}");
}

/// Pantelides 1988, p. 222: the constraint is differentiated twice, the kinematics once; two
/// states.
#[test]
fn pendulum_in_cartesian_coordinates() {
    let blocks = sorted(
        "parameter Real L = 1;
        parameter Real g = 9.81;
        Real x(start = 0.6);
        Real y(start = -0.8);
        Real w;
        Real z;
        Real T;
        equation
        der(x) = w;
        der(y) = z;
        der(w) = T * x;
        der(z) = T * y - g;
        x^2 + y^2 = L^2;",
    );
    // w and z are names of derivatives, so three equations are left, as in der(der(x)) = T x; those
    // after them select the states.
    assert_eq!(differentiations(&blocks.dae), [0, 0, 2, 0, 0, 0, 0]);
    assert_eq!(blocks.states.len(), 2);
    assert_eq!(blocks.dummies.len(), 0);
    // One position and one velocity, whichever determine the others best.
    let of_sets = blocks.state_sets.iter().map(|set| {
        let names = set.candidates.iter().map(|v| blocks.dae.variables[*v].name.as_str());
        (set.states.len(), names.collect::<Vec<_>>().join(" "))
    });
    let of_sets: Vec<(usize, String)> = of_sets.collect();
    assert_eq!(of_sets, [(1, "w z".to_string()), (1, "x y".to_string())]);
    // Both positions from the constraint, both velocities, then the accelerations with T.
    assert_eq!(kinds(&blocks.continuous), "n2 l2 a l1 a");
    assert_eq!(blocks.assumed_starts.len(), 2);
}

#[test]
fn rigidly_connected_masses_move_as_one() {
    let text = "parameter Real m1 = 1;
        parameter Real m2 = 2;
        Real s1;
        Real s2;
        Real v1;
        Real v2;
        Real f;
        equation
        v1 = der(s1);
        v2 = der(s2);
        m1 * der(v1) = f + 1;
        m2 * der(v2) = -f;
        s1 = s2 + 0.5;";
    let blocks = sorted(text);
    assert_eq!(differentiations(&blocks.dae), [0, 0, 2]);
    assert_eq!(states(&blocks), ["s1", "v1"]);
    // Both accelerations and the force depend on each other, linearly, with one torn.
    assert!(kinds(&blocks.continuous).ends_with("l1"), "{}", kinds(&blocks.continuous));
    // The modeller may prefer the other mass.
    let other = sorted(
        &text
            .replace("Real s2;", "Real s2(stateSelect = prefer);")
            .replace("Real v2;", "Real v2(stateSelect = prefer);"),
    );
    assert_eq!(states(&other), ["s2", "v2"]);
    // A start given for the second mass is used.
    let blocks = sorted(&text.replace("Real s2;", "Real s2(start = 3, fixed = true);"));
    assert_eq!(names(&blocks.dae, &blocks.assumed_starts), ["v1"]);
}

#[test]
fn an_algebraic_loop_is_torn() {
    // A bridge of resistors: node potentials and currents depend on each other linearly.
    let blocks = sorted(
        "parameter Real R = 2;
        Real u;
        Real i1;
        Real i2;
        Real i3;
        Real v;
        equation
        u = sin(time);
        u - v = R * i1;
        v = 3 * i2;
        v = 5 * i3;
        i1 = i2 + i3;",
    );
    assert_eq!(kinds(&blocks.continuous), "a l1");
    let Block::Torn(torn) = &blocks.continuous[1] else { panic!() };
    assert_eq!(torn.explicit.len(), 3);
    // A nonlinear loop: x = exp(-y), y = x + time.
    let blocks = sorted("Real x;\nReal y;\nequation\nx = exp(-y);\ny = x + time;");
    assert_eq!(kinds(&blocks.continuous), "n1");
}

#[test]
fn a_coefficient_that_may_vanish_is_not_divided_by() {
    let blocks = sorted("Real x;\nReal y;\nequation\nder(x) = 1;\nx * y = time;");
    // The other block is der(x) := 1.
    assert_eq!(blocks.continuous.len(), 2);
    assert!(kinds(&blocks.continuous).contains("l1"));
    let blocks = sorted(
        "Real x;\nReal y;\nBoolean open;\nequation\nder(x) = 1;\nopen = x > 1;
        0 = if open then y - x else 2 * y;",
    );
    assert_eq!(kinds(&blocks.continuous), "a a");
    let blocks = sorted(
        "Real v;\nReal i;\nBoolean open;\nequation\nopen = time > 1;\nv + i = 1;
        0 = if open then i else v;",
    );
    assert_eq!(kinds(&blocks.continuous), "l1");
}

#[test]
fn bouncing_ball() {
    let blocks = sorted(
        "parameter Real e = 0.7;
        Real h(start = 1, fixed = true);
        Real v(start = 0, fixed = true);
        Boolean flying(start = true);
        Boolean impact;
        equation
        v = der(h);
        der(v) = if flying then -9.81 else 0;
        impact = h <= 0;
        when {impact, h <= 0 and v <= 0} then
        flying = v <= -0.01;
        reinit(v, if flying then -e * v else 0);
        end when;",
    );
    assert_eq!(states(&blocks), ["h", "v"]);
    assert_eq!(kinds(&blocks.continuous), "a");
    // impact, two flags, flying, der(v)
    assert_eq!(kinds(&blocks.event), "a a a a a");
    assert_eq!(blocks.dae.relations.len(), 2);
    assert!(blocks.assumed_starts.is_empty());
}

#[test]
fn discrete_and_continuous_equations_in_one_loop_are_mixed() {
    let blocks = sorted(
        "Real y;
        discrete Real d;
        equation
        y = d + time;
        when sample(0, 1) then
        d = 0.5 * y;
        end when;",
    );
    assert_eq!(kinds(&blocks.continuous), "a");
    assert_eq!(kinds(&blocks.event), "a m");
    let Block::Mixed(parts) = &blocks.event[1] else { panic!() };
    assert_eq!(assignments(&blocks.dae, parts)[0], "y := d + time");
}

#[test]
fn initialisation_at_rest_determines_the_state() {
    let blocks = sorted(
        "parameter Real k(fixed = false);
        Real x(start = 2, fixed = true);
        Real y;
        initial equation
        der(x) = 0;
        der(y) = 0;
        equation
        der(x) = 1 - k * x;
        der(y) = x - y;",
    );
    assert!(blocks.assumed_starts.is_empty());
    // k is found from der(x) = 0, with a coefficient x that may vanish; y from der(y) = 0.
    assert!(determined(&blocks.initial).len() == 5);
    assert!(kinds(&blocks.initial).contains("l1"));
}

#[test]
fn open_starts_are_assumed_for_states() {
    let blocks = sorted("Real x;\nReal y;\nequation\nder(x) = y;\ny = -x;");
    assert_eq!(names(&blocks.dae, &blocks.assumed_starts), ["x"]);
}

#[test]
fn a_missing_equation_is_reported_with_the_variables_it_could_determine() {
    let (codes, text) = problems(
        "Real x;
Real y;
Real z;
Real u = time;
equation
der(x) = u - x;
y + z = 2 * x;
",
    );
    assert_eq!(codes, ["MO0401"]);
    insta::assert_snapshot!(text, @r#"
error[MO0401]: one equation cannot determine 2 unknowns: `y` and `z`
 --> model.mo:2:1
  |
2 | Real y;
  | ^^^^^^ `y` is not determined
3 | Real z;
  | ------ `z` is not determined
...
7 | y + z = 2 * x;
  | ------------- determines only one of them
  |
  = note: see section 8.4 of the Modelica specification
  = note: `M` has 3 equations for 4 unknowns
  = help: add an equation for `y` and `z`, or give one of them a value where it is declared
"#);
}

#[test]
fn a_surplus_equation_is_reported_with_its_competitors() {
    let (codes, text) = problems(
        "Real x;
Real y;
equation
der(x) = -x;
y = 2 * x;
x + y = sin(time);
",
    );
    assert_eq!(codes, ["MO0402"]);
    insta::assert_snapshot!(text, @r#"
error[MO0402]: 3 equations for 2 unknowns: `x` and `y`
 --> model.mo:4:1
  |
4 | der(x) = -x;
  | ^^^^^^^^^^^ der(x) = -x
5 | y = 2 * x;
  | --------- y = 2.0 * x
6 | x + y = sin(time);
  | ----------------- x + y = sin(time)
  |
  = note: see section 8.4 of the Modelica specification
  = note: `M` has 3 equations for 2 unknowns
  = help: remove one of these equations, or make a known quantity in them unknown
"#);
}

#[test]
fn a_singular_system_has_surplus_equations_and_undetermined_unknowns() {
    let (codes, text) = problems(
        "Real a;
Real b;
Real c;
equation
2 * a = time;
a * a = 3;
b + c = a * 2;
",
    );
    assert_eq!(codes, ["MO0401", "MO0402"]);
    insta::assert_snapshot!(text, @r#"
error[MO0401]: one equation cannot determine 2 unknowns: `b` and `c`
 --> model.mo:2:1
  |
2 | Real b;
  | ^^^^^^ `b` is not determined
3 | Real c;
  | ------ `c` is not determined
...
7 | b + c = a * 2;
  | ------------- determines only one of them
  |
  = note: see section 8.4 of the Modelica specification
  = note: `M` has 3 equations for 3 unknowns
  = help: add an equation for `b` and `c`, or give one of them a value where it is declared

error[MO0402]: 2 equations for one unknown: `a`
 --> model.mo:5:1
  |
5 | 2 * a = time;
  | ^^^^^^^^^^^^ 2.0 * a = time
6 | a * a = 3;
  | --------- a * a = 3
  |
  = note: see section 8.4 of the Modelica specification
  = note: `M` has 3 equations for 3 unknowns
  = help: remove one of these equations, or make a known quantity in them unknown
"#);
}

#[test]
fn a_repeated_alias_is_one_equation_too_many() {
    let (codes, text) = problems(
        "Real a;
Real b;
Real c;
equation
a = b;
b = c;
c = a;
",
    );
    // Nothing determines a, and one of the three equations is redundant.
    assert_eq!(codes, ["MO0401", "MO0402"]);
    assert!(text.contains("c = a"), "{text}");
}

#[test]
fn contradicting_constraints_are_found_although_the_counts_agree() {
    let (codes, _) = problems(
        "Real x;
        Real y;
        Real f;
        Real g;
        equation
        der(x) = f + g;
        der(y) = f + g;
        x + y = 1;
        2 * x + 2 * y = 2;",
    );
    assert_eq!(codes, ["MO0403"]);
}

#[test]
fn a_constraint_with_a_called_function_cannot_be_differentiated() {
    let text = "Real x;
        Real y;
        Real g;
        equation
        der(x) = g;
        der(y) = -g;
        x = f(y);";
    assert_eq!(problems(text).0, ["MO0404"]);
    // Without a constraint the call is no obstacle.
    let blocks = sorted(&text.replace("der(y) = -g", "y = g"));
    assert_eq!(states(&blocks), ["x"]);
    // x = f(der(x))
    assert_eq!(kinds(&blocks.continuous), "n1");
}

#[test]
fn starts_fixed_twice_are_named() {
    let (codes, text) = problems(
        "Real x(start = 1, fixed = true);
Real y(start = 2, fixed = true);
Real f;
equation
der(x) = f;
der(y) = -2 * f;
x + y = 1;
",
    );
    assert_eq!(codes, ["MO0408"]);
    insta::assert_snapshot!(text, @r#"
error[MO0408]: the start of the simulation is determined more than once: `x` and `y`
 --> model.mo:1:1
  |
1 | Real x(start = 1, fixed = true);
  | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ start of `x`, fixed
2 | Real y(start = 2, fixed = true);
  | ------------------------------- start of `y`, fixed
...
7 | x + y = 1;
  | --------- x + y = 1.0
  |
  = note: see section 8.6 of the Modelica specification
  = help: remove one initial equation or `fixed = true`
"#);
}

#[test]
fn state_select_that_cannot_be_satisfied() {
    let masses = "Real x(stateSelect = always);
        Real y(stateSelect = always);
        Real f;
        equation
        der(x) = f;
        der(y) = -2 * f;
        x - 2 * y = 1;";
    assert_eq!(problems(masses).0, ["MO0405"]);
    assert_eq!(problems("Real x(stateSelect = never);\nequation\nder(x) = 1;").0, ["MO0406"]);
}

#[test]
fn the_printed_structure_shows_states_and_blocks() {
    let (flat, sources) = model(
        "Real x(start = 1, fixed = true);
        Real y;
        Real f;
        equation
        der(x) = f - x;
        der(y) = -2 * f;
        x + y = 1;",
    );
    let mut problems = Problems::new();
    let dae = lower(flat, &mut problems).unwrap();
    let blocks = structure(dae, &mut problems).unwrap();
    verify(&blocks);
    insta::assert_snapshot!(super::print::print(&blocks, &sources), @r#"
M
  states (1): x
  differentiated but not states (1): y
  differentiated once: x + y = 1.0  [model.mo:7:9]

initialisation: 3 blocks (2 explicit, 1 linear)
  1. x := 1.0  (start)
  2. y := 1.0 - x
  3. linear system of 3, torn to 1: f
       der(x) := f - x
       der(y) := -2.0 * f
       0 = der(x) + der(y)

at events: 2 blocks (1 explicit, 1 linear)
  1. y := 1.0 - x
  2. linear system of 3, torn to 1: f
       der(x) := f - x
       der(y) := -2.0 * f
       0 = der(x) + der(y)

between events: 2 blocks (1 explicit, 1 linear)
  1. y := 1.0 - x
  2. linear system of 3, torn to 1: f
       der(x) := f - x
       der(y) := -2.0 * f
       0 = der(x) + der(y)
"#);
}

/// A ladder of 50 000 masses and springs is sorted in linear time without deep recursion.
#[test]
fn a_long_ladder_is_sorted() {
    let n = 50_000;
    let mut text = String::new();
    // The parser of the fixture resolves names linearly, so the model is repeated as a graph
    // instead.
    text.push_str("Real x;\nReal y;\nequation\nder(x) = y;\ny = -2 * x;\n");
    let (mut flat, _) = model(&text);
    let (x, y) = (flat.variables[VarId(0)].clone(), flat.variables[VarId(1)].clone());
    let mut last = flat.read(VarId(1));
    for i in 0..n {
        let mut add = |v: &crate::ir::flat::Variable, name: &str| {
            let mut v = v.clone();
            v.name = format!("{name}{i}");
            flat.variables.push(v)
        };
        let (x, y) = (add(&x, "x"), add(&y, "y"));
        let (rate, read_x, read_y) = (flat.graph.der(x), flat.read(x), flat.read(y));
        let two = flat.graph.real(2.0);
        let drop = flat.graph.sub(last, read_x);
        let flow = flat.graph.mul(two, drop);
        let mut e = flat.equations[0].clone();
        e.kind = crate::ir::flat::EquationKind::Equal(read_y, flow);
        flat.equations.push(e.clone());
        e.kind = crate::ir::flat::EquationKind::Equal(rate, read_y);
        flat.equations.push(e);
        last = read_y;
    }
    let mut problems = Problems::new();
    let blocks = structure(lower(flat, &mut problems).unwrap(), &mut problems).unwrap();
    assert_eq!(blocks.states.len(), n + 1);
    assert_eq!(blocks.assumed_starts.len(), n + 1);
}

#[test]
fn a_parameter_that_is_zero_is_not_divided_by() {
    // The storage at the port: with V = 0 it has no capacity.
    let blocks = sorted(
        "parameter Real V = 0;\nparameter Real W = V / 2;\nReal p(start = 1, fixed = true);\nReal m;
        equation\nm = time - 2 * der(p);\n0 = m - W * der(p);",
    );
    assert_eq!(kinds(&blocks.continuous), "l1");
    let Block::Torn(torn) = &blocks.continuous[0] else { panic!() };
    let divides = |e| matches!(blocks.dae.graph.node(e), Node::Binary(Binary::Div, ..));
    assert!(torn.explicit.iter().all(|a| !divides(a.value)));
}
