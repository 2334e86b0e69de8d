//! The Bode picture of a linear system: magnitude and phase of each output by each input, over frequency.

use crate::ir::program::Program;
use crate::report::chart::{Chart, Group, Series};
use crate::simulate::frequency_response::FrequencyResponse;
use crate::simulate::linearize::Linearization;

/// Curves that a picture can tell apart.
const MOST: usize = 12;

/// The picture. The error is a message: there is nothing to draw, or too much.
pub fn bode(program: &Program, system: &Linearization) -> Result<Chart, String> {
    let count = system.inputs.len() * system.outputs.len();
    if count == 0 {
        let (what, how) = match system.inputs.is_empty() {
            true => ("input", "declare one with `input`"),
            false => ("output", "name one with `--output NAME`"),
        };
        return Err(format!("--bode: the model has no {what}: {how}"));
    }
    if count > MOST {
        return Err(format!(
            "--bode: {count} pairs of input and output are more than the {MOST} that a picture shows; name the outputs with `--output NAME`"
        ));
    }
    let response = FrequencyResponse::of(system);
    let pairs = system.outputs.iter().flat_map(|y| system.inputs.iter().map(move |u| (y, u)));
    let series = pairs.zip(&response.responses).map(|((y, u), found)| Series {
        label: format!("{} by {}", program.name(*y), program.name(*u)),
        x: response.frequencies.clone(),
        y: vec![Some(found.decibels.clone()), Some(found.phases.clone())],
    });
    Ok(Chart {
        title: format!("{}, linearized at {} s", program.blocks.dae.name, system.time),
        groups: vec![Group { heading: String::new(), series: series.collect() }],
        panels: vec!["magnitude in dB, of SI units".into(), "phase in degrees".into()],
        across: "frequency in Hz".into(),
        logarithmic: true,
    })
}
