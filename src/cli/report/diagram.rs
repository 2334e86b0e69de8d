//! The diagram of the components of a model.

use std::path::PathBuf;

use super::super::args::model::is_standard;
use super::super::args::runs::Report;
use super::super::{Status, write_result};
use super::wrong;
use crate::base::source::SourceMap;
use crate::ir::assembly::Assembly;
use crate::report::raster::png;
use crate::report::schematic::{draw, picture};

/// Pixels of a PNG per px of the diagram.
const PNG_SCALE: u32 = 2;

/// Draws the diagram that `--diagram` asks for, as SVG on the standard output; where it was written.
pub fn write(
    options: &Report,
    assembly: &Assembly,
    sources: &SourceMap,
) -> Result<Vec<PathBuf>, Status> {
    let Some(path) = &options.diagram else { return Ok(Vec::new()) };
    let picture = picture(assembly, 0)
        .ok_or_else(|| wrong("the model has no components to draw, or too many"))?;
    let place = |link: usize| sources.place(assembly.links[link].place).unwrap_or_default();
    let svg = draw::svg(&picture, assembly, &|_| Vec::new(), &place);
    let is_bitmap = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    let bytes = match is_bitmap && !is_standard(path) {
        true => png(&svg, PNG_SCALE).map_err(wrong)?,
        false => svg.into_bytes(),
    };
    write_result(path, &bytes).map_err(wrong)?;
    Ok(vec![path.clone()])
}
