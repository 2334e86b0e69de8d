//! Steady states and linear systems as text.

use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::simulate::linearize::Linearization;

/// A steady state: its values, and how small deviations end.
pub fn steady_text(program: &Program, system: &Linearization) -> String {
    let mut out = format!("{} rests at\n", program.blocks.dae.name);
    let all = [
        ("state", &system.states, &system.x),
        ("input", &system.inputs, &system.u),
        ("output", &system.outputs, &system.y),
    ];
    let lines = all.into_iter().flat_map(|(kind, names, values)| {
        names.iter().zip(values).map(move |(v, x)| (program.name(*v), x, unit(program, *v), kind))
    });
    let lines: Vec<_> = lines.collect();
    let width = lines.iter().map(|(name, ..)| name.chars().count()).max().unwrap_or(0);
    for (name, x, unit, kind) in lines {
        out.push_str(&format!("  {name:width$} = {}{unit}  ({kind})\n", number(*x)));
    }
    out.push_str(&modes(program, system));
    out
}

/// The matrices as one table, states first, and the eigenvalues.
pub fn system_text(program: &Program, system: &Linearization) -> String {
    let name = &program.blocks.dae.name;
    let mut out = format!("{name}, linearized at {} s\n", number(system.time));
    let columns: Vec<&str> =
        system.states.iter().chain(&system.inputs).map(|v| program.name(*v)).collect();
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    let (n, m) = (system.states.len(), system.inputs.len());
    let row = |left: &[f64], right: &[f64], k: usize| {
        let part = |all: &[f64], width: usize| all[k * width..(k + 1) * width].to_vec();
        part(left, n).into_iter().chain(part(right, m)).map(number).collect::<Vec<_>>()
    };
    for (k, v) in system.states.iter().enumerate() {
        rows.push((format!("der({})", program.name(*v)), row(&system.a, &system.b, k)));
    }
    for (k, v) in system.outputs.iter().enumerate() {
        rows.push((program.name(*v).to_owned(), row(&system.c, &system.d, k)));
    }
    let first = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns.len())
        .map(|j| {
            let cells = rows.iter().map(|(_, cells)| cells[j].chars().count());
            cells.max().unwrap_or(0).max(columns[j].chars().count())
        })
        .collect();
    let mut line = |name: &str, cells: &mut dyn Iterator<Item = &str>| {
        let mut text = format!("  {name:first$}");
        for (j, cell) in cells.enumerate() {
            let bar = if j == n && m > 0 { " |" } else { "" };
            text.push_str(&format!("{bar}  {cell:>width$}", width = widths[j]));
        }
        out.push_str(text.trim_end());
        out.push('\n');
    };
    line("", &mut columns.iter().copied());
    for (name, cells) in &rows {
        line(name, &mut cells.iter().map(String::as_str));
    }
    out.push_str(&modes(program, system));
    out
}

/// States that are named with an eigenvalue at most.
const MOST_NAMED: usize = 4;
/// Least part of a state that is named.
const LEAST_PART: f64 = 0.05;

/// The states that take part in an eigenvalue, the greatest part first.
fn named(program: &Program, system: &Linearization, parts: &[f64]) -> String {
    let mut all: Vec<(&VarId, f64)> =
        system.states.iter().zip(parts.iter().copied()).filter(|(_, p)| *p >= LEAST_PART).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let one =
        |(state, part): &(&VarId, f64)| format!("{} {:.0} %", program.name(**state), 100.0 * part);
    let names: Vec<String> = all.iter().take(MOST_NAMED).map(one).collect();
    if names.is_empty() { String::new() } else { format!("; {}", names.join(", ")) }
}

/// The eigenvalues as time constants and oscillations, each with the states that take part in it.
fn modes(program: &Program, system: &Linearization) -> String {
    let Some(all) = system.eigenvalues() else {
        return "the eigenvalues cannot be computed\n".to_owned();
    };
    let mut out = String::new();
    if !all.is_empty() {
        out.push_str("  eigenvalues, 1/s\n");
    }
    let size = all.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let parts = system.participation(&all).unwrap_or_default();
    for (k, x) in all.iter().enumerate() {
        let what = match (x.re, x.im) {
            (_, im) if im < 0.0 => continue,
            _ if x.abs() <= 1e-12 * size || x.abs() == 0.0 => "an integrator".to_owned(),
            (re, 0.0) if re < 0.0 => {
                format!("decays with the time constant {} s", number(-1.0 / re))
            }
            (re, 0.0) => format!("grows with the time constant {} s", number(1.0 / re)),
            (re, im) => format!(
                "oscillates with {} Hz, damping ratio {}",
                number(im / std::f64::consts::TAU),
                number(-re / re.hypot(im)),
            ),
        };
        let shown = match x.im {
            0.0 => number(x.re),
            im => format!("{} ± {}i", number(x.re), number(im)),
        };
        let states = parts.get(k).map_or(String::new(), |parts| named(program, system, parts));
        out.push_str(&format!("    {shown}  {what}{states}\n"));
    }
    out
}

/// A unit after a number.
fn unit(program: &Program, v: VarId) -> String {
    let unit = &program.blocks.dae.variables[v].unit;
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Six digits.
fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&size) {
        let text = format!("{x:.5e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", trimmed(digits));
    }
    let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
    trimmed(&format!("{x:.decimals$}")).to_owned()
}

fn trimmed(digits: &str) -> &str {
    match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    }
}
