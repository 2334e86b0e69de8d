//! Small models against the equations of appendix B of the Modelica specification.

use super::fixture::model;
use super::lower;
use crate::base::diag::Problems;
use crate::base::render::{Style, render_all};
use crate::ir::dae::{Dae, Trigger, VariableKind};
use crate::ir::expr::{ExprId, Node, VarId};
use crate::symbolic::print;

fn lowered(text: &str) -> Dae {
    let (flat, sources) = model(text);
    let mut problems = Problems::new();
    let dae = lower(flat, &mut problems);
    dae.unwrap_or_else(|| panic!("{}", render_all(&problems, &sources, Style::Plain)))
}

fn codes(text: &str) -> Vec<&'static str> {
    let (flat, _) = model(text);
    let mut problems = Problems::new();
    lower(flat, &mut problems);
    problems.sorted().iter().map(|d| d.code).collect()
}

fn find(dae: &Dae, name: &str) -> VarId {
    let found = dae.variables.enumerate().find(|(_, v)| v.name == name);
    found.unwrap_or_else(|| panic!("no variable {name}")).0
}

fn shown(dae: &Dae, e: ExprId) -> String {
    print::print(&dae.graph, e, &|v| dae.variables[v].name.clone())
}

fn eliminated(dae: &Dae) -> Vec<String> {
    let entry =
        |(v, e): &(VarId, ExprId)| format!("{} = {}", dae.variables[*v].name, shown(dae, *e));
    dae.eliminated.iter().map(entry).collect()
}

fn equations(dae: &Dae) -> Vec<String> {
    dae.equations.iter().map(|e| format!("{} = {}", shown(dae, e.lhs), shown(dae, e.rhs))).collect()
}

fn discrete(dae: &Dae) -> Vec<String> {
    let entry = |d: &crate::ir::dae::DiscreteEquation| {
        format!("{} := {}", dae.variables[d.variable].name, shown(dae, d.value))
    };
    dae.discrete.iter().map(entry).collect()
}

#[test]
fn alias_chains_keep_their_signs_and_attributes() {
    let dae = lowered(
        "Real a(start = 2, fixed = true, min = -1);
        Real b; Real c(max = 5);
        Real d;
        equation
        a + b = 0;
        b = -c;
        -c = -d;
        der(c) = d;"
            .replace("Real b; Real c", "Real b;\n Real c")
            .as_str(),
    );
    // b = -a, c = a, d = a; c is written under der.
    assert_eq!(eliminated(&dae), ["a = c", "b = -c", "d = c"]);
    assert_eq!(equations(&dae), ["der(c) = c"]);
    let c = &dae.variables[find(&dae, "c")];
    assert_eq!(c.fixed, Some(true));
    assert_eq!(c.start.map(|e| shown(&dae, e)), Some("2.0".into()));
    assert_eq!(c.min.map(|e| shown(&dae, e)), Some("-1.0".into()));
    assert_eq!(c.max.map(|e| shown(&dae, e)), Some("5.0".into()));
}

#[test]
fn bounds_swap_under_a_negative_alias() {
    let dae = lowered(
        "Real x(min = 0, max = 4);
        Real y(min = -3, start = -1);
        equation
        x = -y;
        der(x) = 1;",
    );
    let x = &dae.variables[find(&dae, "x")];
    let text = |e: Option<ExprId>| e.map(|e| shown(&dae, e)).unwrap_or_default();
    assert_eq!([text(x.min), text(x.max), text(x.start)], ["0.0", "3.0", "1.0"]);
}

#[test]
fn a_named_derivative_is_the_derivative() {
    let dae = lowered(
        "Real s;
        Real v;
        Real a;
        equation
        v = der(s);
        a = der(v);
        a = -s;",
    );
    // s = -a puts a into the class of s, so `a = der(v)` remains an equation.
    let s = find(&dae, "s");
    let v = find(&dae, "v");
    assert_eq!(dae.variables[s].kind, VariableKind::Differentiated { derivative: v });
    assert_eq!(dae.variables[v].derivative_of, Some(s));
    assert_eq!(equations(&dae), ["-s = der(v)"]);
    assert_eq!(eliminated(&dae), ["a = -s", "der(s) = v"]);
}

#[test]
fn a_negative_name_leaves_the_derivative_a_variable_of_its_own() {
    let dae = lowered(
        "Real q;
        Real i;
        equation
        i = -der(q);
        i = q;",
    );
    // i = q, so the equation is an ordinary one: der(q) = -q.
    assert_eq!(dae.equations.len(), 1);
    let dae = lowered(
        "Real q;
        Real i;
        Real r;
        equation
        i = -der(q);
        i = 2 * q;
        r = der(i);",
    );
    assert_eq!(eliminated(&dae), ["i = -der(q)", "r = -der(der(q))"]);
    assert_eq!(equations(&dae), ["-der(q) = 2.0 * q"]);
}

#[test]
fn constants_have_no_equation_and_no_derivative() {
    let dae = lowered(
        "parameter Real p = 3;
        Real g;
        Real n;
        Real w;
        equation
        g = 0;
        n + g = 0;
        w = 2 * p;
        der(w) = n;",
    );
    assert_eq!(eliminated(&dae), ["g = 0.0", "n = 0.0", "w = 2.0 * p"]);
    assert_eq!(equations(&dae), ["0.0 = 0.0"]);
}

#[test]
fn parameters_come_in_order_and_cycles_are_named() {
    let dae = lowered(
        "parameter Real a = 2 * b;
        parameter Real b = c + 1;
        parameter Real c = 1;
        parameter Real f(fixed = false);
        parameter Real h = f * c;",
    );
    let order: Vec<&str> =
        dae.parameters.iter().map(|(v, _)| dae.variables[*v].name.as_str()).collect();
    assert_eq!(order, ["c", "b", "a"]);
    assert_eq!(dae.variables[find(&dae, "h")].kind, VariableKind::InitialParameter);
    assert_eq!(dae.initial.len(), 1);
}

#[test]
fn problems_with_parameters() {
    assert_eq!(codes("parameter Real a = b;\nparameter Real b = 2 * a;"), ["MO0301"]);
    assert_eq!(codes("parameter Real a(start = 1);"), ["MO0302"]);
    assert_eq!(codes("parameter Real a;"), ["MO0303"]);
    assert_eq!(codes("Real x = time;\nparameter Real a = x + 1;"), ["MO0304"]);
}

#[test]
fn equal_variables_cannot_start_at_different_values() {
    let text = "Real a(start = 1, fixed = true);
        Real b(start = 2, fixed = true);
        equation
        a = b;
        der(a) = 1;";
    assert_eq!(codes(text), ["MO0305"]);
    assert_eq!(codes(&text.replace("start = 2", "start = 1")), Vec::<&str>::new());
}

#[test]
fn relations_are_shared_with_their_negation_and_classified() {
    let dae = lowered(
        "parameter Real t0 = 2;
        Real x;
        Real y;
        Boolean b;
        Boolean c;
        Boolean d;
        equation
        der(x) = if time >= t0 then 1 else 0;
        y = noEvent(if x > 0 then x else 0);
        b = x < 1;
        c = x >= 1;
        d = 1 > x and time < t0;",
    );
    assert_eq!(dae.relations.len(), 2);
    let Trigger::Time { instant } = dae.relations[0].trigger else { panic!("time event") };
    assert_eq!(shown(&dae, instant), "t0");
    assert_eq!(dae.relations[1].trigger, Trigger::State);
    assert_eq!(
        discrete(&dae),
        ["b := $relation[2]", "c := not $relation[2]", "d := $relation[2] and not $relation[1]"]
    );
    assert_eq!(equations(&dae)[1], "y = if x > 0.0 then x else 0.0");
}

#[test]
fn invalid_events_are_rejected() {
    let x = "Real x;\nReal y;\nequation\nder(x) = 1;\n";
    assert_eq!(codes(&format!("{x}y = if x == 1 then 2 else 3;")), ["MO0309"]);
    assert_eq!(codes(&format!("{x}y = noEvent(floor(x));")), Vec::<&str>::new());
    assert_eq!(codes(&format!("{x}y = 1;\nwhen x > 1 then\nreinit(y, 2);\nend when;")), ["MO0312"]);
}

#[test]
fn a_when_clause_becomes_discrete_equations_with_an_activation() {
    let dae = lowered(
        "Real x;
        discrete Real d;
        Integer n;
        equation
        der(x) = 1;
        when {initial(), x > 1} then
        d = x;
        n = pre(n) + 1;
        elsewhen sample(0, 2) then
        n = 0;
        reinit(x, 0);
        end when;",
    );
    let first = "initial() or $when1 and not pre($when1)";
    let second = "not initial() and ($when2 and not pre($when2))";
    assert_eq!(
        discrete(&dae),
        [
            "$when1 := $relation[1]".to_string(),
            "$when2 := $sample1".to_string(),
            format!("d := if {first} then x else pre(d)"),
            format!(
                "n := if {first} then pre(n) + 1 elseif {second} and not ({first}) then 0 \
                 else pre(n)"
            ),
        ]
    );
    assert_eq!(dae.samples.len(), 1);
    let active = shown(&dae, dae.reinits[0].active);
    assert_eq!(active, format!("{second} and not ({first})"));
}

#[test]
fn a_variable_has_one_when_clause() {
    let text = "Integer n;
        equation
        when time > 1 then
        n = 1;
        end when;
        when time > 2 then
        n = 2;
        end when;";
    assert_eq!(codes(text), ["MO0306"]);
    let differentiated = format!("{}\n", text.replace("Integer n;", "Real n;\nReal y;"))
        .replace("equation", "equation\ny = der(n);")
        .replace("when time > 2 then\n        n = 2;\n        end when;", "");
    assert_eq!(codes(&differentiated), ["MO0316"]);
    assert_eq!(codes("Boolean b;\nequation"), ["MO0307"]);
    assert_eq!(
        codes("Boolean b;\nBoolean c;\nequation\n(b and c) = true;\nb = true;"),
        ["MO0307", "MO0308"]
    );
}

#[test]
fn first_values_of_discrete_variables() {
    let dae = lowered(
        "Integer n;
        Real x;
        initial equation
        n = 3;
        equation
        der(x) = n;
        when x > 1 then
        n = pre(n) + 1;
        end when;",
    );
    let n = &dae.variables[find(&dae, "n")];
    assert_eq!(n.start.map(|e| shown(&dae, e)), Some("3".into()));
    assert!(discrete(&dae)[1].starts_with("n := if initial() then 3 elseif"));
    assert!(dae.initial.is_empty());
}

/// An alias chain of 200 000 variables is one class, found without recursion and in linear time.
#[test]
fn a_long_alias_chain_is_one_variable() {
    let (mut flat, _) = model("Real x0;\nequation\nder(x0) = -x0;");
    let n = 200_000;
    let mut last = VarId(0);
    for i in 1..=n {
        let mut v = flat.variables[VarId(0)].clone();
        v.name = format!("x{i}");
        let id = flat.variables.push(v);
        let (a, b) = (flat.read(last), flat.read(id));
        let negative = flat.graph.neg(b);
        let mut e = flat.equations[0].clone();
        e.kind = crate::ir::flat::EquationKind::Equal(a, negative);
        flat.equations.push(e);
        last = id;
    }
    let dae = lower(flat, &mut Problems::new()).unwrap();
    assert_eq!(dae.equations.len(), 1);
    assert_eq!(dae.eliminated.len(), n);
    assert_eq!(shown(&dae, dae.eliminated[0].1), "-x0");
    assert!(matches!(dae.graph.node(dae.eliminated[n - 1].1), Node::Var(VarId(0))));
}
