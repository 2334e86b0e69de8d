//! A compiled model to the archive of an FMU.
//!
//! In: a program, the causality of its top-level variables, and the shared library that runs programs. Out: the
//! bytes of the archive.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::external::transfer;
use crate::ir::expr::{Type, VarId};
use crate::ir::flat::Causality;
use crate::ir::program::{Program, Slot};
use crate::simulate::settings::Settings;

use super::archive::pack;
use super::cause::FmuCause;
use super::dependencies::Dependencies;
use super::description::{Description, Version, initial_unknowns, text};
use super::disclosure::disclosed;
use super::exchange::count_indicators;
use super::interface::{FIRST_DERIVATIVE, Initial, Role, Scalar, Varies, reference, scalars};
use super::package::{FILE, token_of, write};
use super::terminals::{self, Connector};

/// The folder of terminals and icons in FMI 3.
const ICONS: &str = "terminalsAndIcons";

/// What to make.
pub struct Order<'a> {
    /// The version of FMI.
    pub version: Version,
    /// Model Exchange is wanted.
    pub exchange: bool,
    /// Co-Simulation is wanted.
    pub stepping: bool,
    /// The shared library.
    pub runtime: &'a [u8],
    /// The connectors of the model.
    pub connectors: &'a [Connector],
    /// Its picture, as PNG and as SVG.
    pub icon: Option<(Vec<u8>, String)>,
    /// Further files: their names in the archive, and contents.
    pub extra: Vec<(String, Vec<u8>)>,
    /// Messages may name the operands of relations.
    pub with_source: bool,
}

/// The archive, and a warning if it offers less than was asked for.
pub fn export(
    program: &Program,
    causalities: &[(String, Causality)],
    order: &Order<'_>,
) -> Result<(Vec<u8>, Option<Diagnostic>), Box<Diagnostic>> {
    let model = program.blocks.dae.name.clone();
    if let Some(input) = program.differentiated_input() {
        let input = program.name(input).to_owned();
        let cause = FmuCause::DifferentiatedInput { model, input };
        return Err(Box::new(Diagnostic::new(cause, Span::NONE)));
    }
    let varies = !program.state_sets.is_empty();
    let mut warning = None;
    if varies && order.exchange {
        let cause = match order.stepping {
            true => FmuCause::OnlyStepping { model: model.clone() },
            false => FmuCause::StatesVary { model: model.clone() },
        };
        let diagnostic = Diagnostic::new(cause, Span::NONE);
        if !order.stepping {
            return Err(Box::new(diagnostic));
        }
        warning = Some(diagnostic);
    }
    for function in program.externals().all() {
        if !transfer::write(&**function, &mut Vec::new()) {
            let name = function.signature().name.to_owned();
            let cause = FmuCause::NotTransferable { name };
            return Err(Box::new(Diagnostic::new(cause, Span::NONE)));
        }
    }
    let reduced = disclosed(program, order.with_source);
    let all = scalars(program, causalities);
    let token = token_of(&write(&reduced, &format!("{model} {all:?}")));
    let settings = Settings::of(&program.blocks.dae.experiment);
    let identifier = identifier(&model);
    let description = text(&Description {
        version: order.version,
        model: &model,
        identifier: &identifier,
        token: &token,
        exchange: order.exchange && !varies,
        stepping: order.stepping,
        scalars: &all,
        enumerations: program.blocks.dae.graph.enumerations.as_slice(),
        indicators: if varies { 0 } else { count_indicators(program) },
        dependencies: &dependencies(program, &all),
        initial_dependencies: &initial_dependencies(program, &all),
        experiment: [settings.start, settings.stop, settings.interval],
        tolerance: settings.tolerance,
        differentiable: program.layout.delays.is_empty() && program.layout.transports.is_empty(),
    });
    let platform = match order.version {
        Version::Two => "linux64",
        Version::Three => "x86_64-linux",
    };
    let package = write(&reduced, &token);
    let mut files: Vec<(String, &[u8])> = vec![
        ("modelDescription.xml".to_owned(), description.as_bytes()),
        (format!("binaries/{platform}/{identifier}.so"), order.runtime),
        (format!("resources/{FILE}"), &package),
    ];
    let terminals = terminals::text(order.connectors, &all);
    if let Some((png, svg)) = &order.icon {
        match order.version {
            Version::Two => files.push(("model.png".to_owned(), png)),
            Version::Three => files.extend([
                (format!("{ICONS}/terminalsAndIcons.xml"), terminals.as_bytes()),
                (format!("{ICONS}/icon.png"), &png[..]),
                (format!("{ICONS}/icon.svg"), svg.as_bytes()),
            ]),
        }
    }
    files.extend(order.extra.iter().map(|(name, content)| (name.clone(), &content[..])));
    let packed = pack(&files).map_err(|why| {
        Diagnostic::new(FmuCause::FileOfFmu { path: "the archive".to_owned(), why }, Span::NONE)
    })?;
    Ok((packed, warning))
}

/// The name of the model as a C identifier.
pub fn identifier(model: &str) -> String {
    let legal = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mapped: String = model.chars().map(legal).collect();
    if mapped.starts_with(|c: char| c.is_ascii_digit()) { format!("_{mapped}") } else { mapped }
}

/// The slot of a variable or of a derivative.
fn slot_of(program: &Program, reference: u32) -> Slot {
    match reference.checked_sub(FIRST_DERIVATIVE) {
        Some(k) => program.layout.derivatives[k as usize],
        None => program.layout.variables[reference as usize - 1],
    }
}

/// The slot that the importer sets for an input.
fn signal(program: &Program, reference: u32) -> Slot {
    let signals = &program.layout.signals;
    let own = signals.iter().find(|(v, order, _)| v.0 + 1 == reference && *order == 0);
    own.map_or_else(|| slot_of(program, reference), |(.., slot)| *slot)
}

/// For outputs and derivatives the states and inputs that they depend on, by value reference.
fn dependencies(program: &Program, all: &[Scalar]) -> Vec<(u32, Vec<u32>)> {
    let layout = &program.layout;
    let states = program.blocks.states.iter().enumerate();
    let mut knowns: Vec<(u32, Slot)> =
        states.map(|(k, s)| (reference(s.variable), layout.states + k as Slot)).collect();
    let inputs = all.iter().filter(|s| s.role == Role::Input && s.ty == Type::Real);
    knowns.extend(inputs.map(|s| (s.reference, signal(program, s.reference))));
    let slots: Vec<Slot> = knowns.iter().map(|(_, slot)| *slot).collect();
    let traced = Dependencies::trace(program, &slots);
    let unknown = |s: &&Scalar| {
        (s.role == Role::Output && s.ty == Type::Real) || s.reference >= FIRST_DERIVATIVE
    };
    let of = |s: &Scalar| {
        let slot = slot_of(program, s.reference);
        (s.reference, traced.of(slot).into_iter().map(|k| knowns[k].0).collect())
    };
    all.iter().filter(unknown).map(of).collect()
}

/// For unknowns of the initialization the parameters, start values and inputs that they depend on.
fn initial_dependencies(program: &Program, all: &[Scalar]) -> Vec<(u32, Vec<u32>)> {
    let layout = &program.layout;
    let known = |s: &Scalar| {
        let v = VarId(s.reference - 1);
        let is_set = matches!(s.initial, Some(Initial::Exact | Initial::Approx));
        let parameter = || layout.parameter_inputs.iter().find(|(p, _)| *p == v).map(|(_, k)| *k);
        let start = || layout.starts.iter().find(|(p, ..)| *p == v).map(|(_, k, _)| *k);
        match s.role {
            Role::Input => Some((s.reference, signal(program, s.reference))),
            _ if is_set && s.varies != Varies::Constant => {
                parameter().or_else(start).map(|slot| (s.reference, slot))
            }
            _ => None,
        }
    };
    let own = all.iter().filter(|s| s.reference < FIRST_DERIVATIVE);
    let knowns: Vec<(u32, Slot)> = own.filter_map(known).collect();
    let slots: Vec<Slot> = knowns.iter().map(|(_, slot)| *slot).collect();
    let traced = Dependencies::trace_initial(program, &slots);
    let of = |s: &&Scalar| {
        let on = traced.of(slot_of(program, s.reference)).into_iter().map(|k| knowns[k].0);
        (s.reference, on.filter(|r| *r != s.reference).collect())
    };
    initial_unknowns(all).iter().map(of).collect()
}
