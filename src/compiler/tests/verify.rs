//! Each check finds nothing in what the stages make, and finds what is corrupted.

use crate::base::diag::Problems;
use crate::base::index::Id;
use crate::base::source::Span;
use crate::ir::blocks::{Block, Blocks};
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Function, LocalId, Statement, Variability};
use crate::ir::instance::InstanceKind;
use crate::ir::program::{Entry, Instr, Op, Program};
use crate::ir::trajectory::{Column, Trajectory};
use mocc_engine::verify::*;

const MODEL: &str = "parameter Real k = 2;
parameter Real c = 3 * k;
Real x(start = 1, fixed = true);
Real v(start = 0, fixed = true);
Real a;
Real b;
Real y;
Integer n(start = 0, fixed = true);
equation
der(x) = v;
der(v) = -c * x - a;
a + sin(b) = x;
b + sin(a) = 2 * v;
y = 3 * x;
when {x < 0.5} then
n = pre(n) + 1;
end when;";

fn flat() -> FlatModel {
    crate::lower::fixture::model(MODEL).0
}

fn dae() -> Dae {
    let mut problems = Problems::new();
    crate::lower::lower(flat(), &mut problems).expect("a system")
}

fn blocks() -> Blocks {
    let mut problems = Problems::new();
    crate::structure::structure(dae(), &mut problems).expect("blocks")
}

fn program() -> Program {
    crate::codegen::compile(blocks()).unwrap_or_else(|problems| panic!("{problems:?}"))
}

/// The check finds something after the corruption, and nothing before.
fn finds<T>(made: T, check: impl Fn(&T) -> Vec<String>, corrupt: impl FnOnce(&mut T), what: &str) {
    let mut made = made;
    assert_eq!(check(&made), Vec::<String>::new());
    corrupt(&mut made);
    let found = check(&made);
    assert!(found.iter().any(|violation| violation.contains(what)), "{what}: {found:?}");
}

fn variable(dae: &Dae, name: &str) -> VarId {
    dae.variables.enumerate().find(|(_, x)| x.name == name).expect(name).0
}

#[test]
fn flat_models() {
    finds(flat(), flat::check, |m| m.variables[VarId(0)].name = "c".into(), "not unique");
    finds(
        flat(),
        flat::check,
        |m| m.variables[VarId(2)].binding = Some(ExprId(9999)),
        "no expression",
    );
    let text = |m: &mut FlatModel| m.graph.constant(Const::String("t".into()));
    finds(flat(), flat::check, |m| m.variables[VarId(2)].binding = Some(text(m)), "its binding");
    finds(
        flat(),
        flat::check,
        |m| m.variables[VarId(2)].variability = Variability::Discrete,
        "der() of a variable that is not continuous",
    );
    let of_strings = |m: &mut FlatModel| {
        let (string, number) = (text(m), m.graph.real(1.0));
        m.equations[0].kind = EquationKind::Equal(string, number);
    };
    finds(flat(), flat::check, of_strings, "an equation of String and Real");
    let of_nothing = |m: &mut FlatModel| {
        let value = m.graph.real(1.0);
        let outputs = vec![VarId(999)];
        m.equations[0].kind = EquationKind::Algorithm { outputs, values: vec![value] };
    };
    finds(flat(), flat::check, of_nothing, "is assigned and does not exist");
    let condition = |m: &mut FlatModel| {
        let one = m.graph.real(1.0);
        let e = m.graph.intern(Node::If(one, one, one), Type::Real);
        m.variables[VarId(2)].start = Some(e);
    };
    finds(flat(), flat::check, condition, "a condition has type Real");
}

#[test]
fn functions() {
    let with = |change: fn(&mut FlatModel, &mut Function)| {
        move |m: &mut FlatModel| {
            let (active, x) =
                (m.graph.var(VarId(0), Type::Boolean), m.graph.var(VarId(1), Type::Real));
            let id = LocalId::from_usize;
            let mut function = Function {
                name: "f".to_owned(),
                span: Span::NONE,
                inputs: vec![id(0), id(1)],
                outputs: vec![id(2)],
                locals: ["active", "x", "y"].map(str::to_owned).into_iter().collect(),
                body: vec![Statement::If(active, vec![Statement::Assign(id(2), x)], Vec::new())],
            };
            change(m, &mut function);
            m.functions.push(function);
        }
    };
    let mut sound = flat();
    with(|_, _| ())(&mut sound);
    assert_eq!(flat::check(&sound), Vec::<String>::new());
    let cases: [(fn(&mut FlatModel, &mut Function), &str); 4] = [
        (|_, f| f.outputs.push(LocalId::from_usize(3)), "an input or output that does not exist"),
        (
            |m, f| f.body.push(Statement::Assign(LocalId::from_usize(2), m.graph.der(VarId(0)))),
            "a variable",
        ),
        (
            |m, f| f.body.push(Statement::Assign(LocalId::from_usize(9), m.graph.real(1.0))),
            "assigns",
        ),
        (|m, f| f.body.push(Statement::While(m.graph.real(1.0), Vec::new())), "is not Boolean"),
    ];
    for (change, what) in cases {
        finds(flat(), flat::check, with(change), what);
    }
}

#[test]
fn systems() {
    let derivative = |d: &mut Dae| {
        let e = d.graph.intern(Node::Der(VarId(2)), Type::Real);
        d.discrete[0].value = e;
    };
    finds(dae(), dae::check, derivative, "derivatives are variables");
    finds(dae(), dae::check, |d| d.relations.clear(), "there is no such relation");
    finds(dae(), dae::check, |d| d.parameters.reverse(), "which is not before it");
    finds(dae(), dae::check, |d| d.discrete.push(d.discrete[0].clone()), "two discrete equations");
    let rate = |d: &mut Dae| {
        let (x, v) = (variable(d, "x"), variable(d, "a"));
        d.variables[x].kind = VariableKind::Differentiated { derivative: v };
    };
    finds(dae(), dae::check, rate, "is not its derivative");
    let y = |d: &mut Dae| {
        let y = variable(d, "y");
        d.variables[y].kind = VariableKind::Eliminated;
    };
    finds(dae(), dae::check, y, "is eliminated without a value");
}

#[test]
fn sorted_systems() {
    let sequence = |b: &mut Blocks| b.continuous.push(b.continuous[0].clone());
    finds(blocks(), blocks::check, sequence, "is solved twice");
    finds(blocks(), blocks::check, |b| b.continuous.reverse(), "before it is solved");
    let tearing = |b: &mut Blocks| {
        for block in &mut b.continuous {
            if let Block::Torn(torn) = block {
                torn.residuals.clear();
            }
        }
    };
    finds(blocks(), blocks::check, tearing, "tearing variables");
}

#[test]
fn programs() {
    let slot = |p: &mut Program| {
        let beyond = p.image.len() as u32;
        p.tapes.rhs.push(Instr { op: Op::Neg, dst: beyond, a: 0, b: 0 });
    };
    finds(program(), program::check, slot, "refers to nothing");
    let early = |p: &mut Program| {
        let temporary = p.image.len() as u32;
        p.image.extend([0.0, 0.0]);
        let (dst, other) = (temporary, temporary + 1);
        p.tapes.rhs.push(Instr { op: Op::Neg, dst, a: other, b: other });
        p.tapes.rhs.push(Instr { op: Op::Neg, dst: other, a: dst, b: dst });
    };
    finds(program(), program::check, early, "too early");
    finds(program(), program::check, |p| p.jacobian_entries.clear(), "has no entry");
    let outside = |p: &mut Program| p.jacobian_entries.push(Entry { row: 99, column: 0, slot: 0 });
    finds(program(), program::check, outside, "lies outside");
}

#[test]
fn trajectories() {
    let mut run = Trajectory::new(vec![Column::new("x", "m")]);
    run.push(0.0, &[1.0]);
    finds(run.clone(), trajectory::check, |run| run.push(-1.0, &[1.0]), "goes back");
    finds(run, trajectory::check, |run| run.push(1.0, &[f64::NAN]), "NaN");
}

fn parsed(text: &str) -> crate::ir::ast::File {
    let mut sources = crate::base::source::SourceMap::default();
    let id = sources.add("model.mo", text);
    crate::parse::grammar::parse(id, text, &mut Problems::new())
}

#[test]
fn syntax_trees() {
    let text = "model M Real x(start = 1) = 2; equation der(x) = sin(x) + x; end M;";
    let corrupt = |file: &mut crate::ir::ast::File, span: Span| {
        let class = std::sync::Arc::make_mut(&mut file.classes[0]);
        class.name.span = span;
    };
    let at = |start, end| move |id| Span::new(id, start, end);
    let outside = |file: &mut crate::ir::ast::File| corrupt(file, at(900, 901)(file.id));
    finds(parsed(text), ast::check, outside, "is not inside");
    let nameless = |file: &mut crate::ir::ast::File| {
        std::sync::Arc::make_mut(&mut file.classes[0]).name.name = "".into();
    };
    finds(parsed(text), ast::check, nameless, "is empty");
    let broken = |file: &mut crate::ir::ast::File| {
        let class = std::sync::Arc::make_mut(&mut file.classes[0]);
        let crate::ir::ast::ClassBody::Long(body) = &mut class.body else {
            panic!("a short class")
        };
        let mut equations = body.equations[0].equations.to_vec();
        equations[0].kind = crate::ir::ast::EquationKind::Broken;
        body.equations[0].equations = equations.into();
    };
    finds(parsed(text), ast::check, broken, "a broken equation");
}

#[test]
fn trees_of_instances() {
    let mut sources = crate::base::source::SourceMap::default();
    let mut problems = Problems::new();
    let mut library = crate::resolve::library::Library::new(Vec::new());
    let graph = crate::classes::ClassGraph::new(&mut sources, &mut problems, &mut library);
    let cx = crate::evaluate::Evaluator::new(graph);
    let made = cx.instances.clone();
    let corrupt = |tree: &mut crate::base::index::IndexVec<_, crate::ir::instance::Instance>| {
        let mut first = tree.iter().next().expect("the root").clone();
        first.kind = InstanceKind::InProgress;
        tree.push(first);
    };
    finds(made, instance::check, corrupt, "in progress");
}

#[test]
fn a_report_names_the_stage_and_the_representation() {
    let text = report("lower", "dae", &vec!["x is wrong".to_owned(); 25]);
    assert!(text.starts_with("`lower` broke the contract of `ir::dae`:\n  x is wrong\n"));
    assert!(text.ends_with("and 5 more"));
}
