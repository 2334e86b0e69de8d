//! The causes of diagnostics of all stages, in one table.
//!
//! *In:* the entries of each stage, declared with [`causes!`](crate::base::cause::causes). *Out:* all entries in the
//! order of their codes.

use crate::base::cause::Entry;
use crate::base::toml_file::TomlCause;
use crate::calibrate::cause::{PlanCause, RecordingCause};
use crate::classes::cause::ClassCause;
use crate::classes::unsupported::LanguageCause;
use crate::clocks::error::ClockCause;
use crate::codegen::error::CodegenCause;
use crate::diagnose::cause::CatalogueCause;
use crate::driver::cause::RequestCause;
use crate::driver::quantity::QuantityCause;
use crate::evaluate::cause::array::ArrayCause;
use crate::evaluate::cause::builtin::BuiltinCause;
use crate::evaluate::cause::call::CallCause;
use crate::evaluate::cause::name::NameCause;
use crate::evaluate::cause::types::TypeCause;
use crate::evaluate::cause::value::ValueCause;
use crate::flatten::cause::{FlattenCause, OverrideCause};
use crate::flatten::connect::cause::ConnectCause;
use crate::fmu::cause::FmuCause;
use crate::instantiate::cause::InstantiateCause;
use crate::lower::error::LoweringCause;
use crate::measure::error::MeasureCause;
use crate::optimize::cause::DesignCause;
use crate::parse::error::SyntaxCause;
use crate::regression::cause::TestCause;
use crate::resolve::cause::LibraryCause;
use crate::rules::cause::element::ElementCause;
use crate::rules::cause::specialized_class::SpecializedClassCause;
use crate::simulate::cause::RunCause;
use crate::structure::error::StructureCause;
use crate::units::cause::UnitCause;

/// The causes of each stage. A new enum of causes gets a line here.
const STAGES: &[&[Entry]] = &[
    SyntaxCause::ENTRIES,
    LibraryCause::ENTRIES,
    RequestCause::ENTRIES,
    LanguageCause::ENTRIES,
    ClassCause::ENTRIES,
    ElementCause::ENTRIES,
    SpecializedClassCause::ENTRIES,
    InstantiateCause::ENTRIES,
    NameCause::ENTRIES,
    TypeCause::ENTRIES,
    ArrayCause::ENTRIES,
    CallCause::ENTRIES,
    BuiltinCause::ENTRIES,
    ValueCause::ENTRIES,
    FlattenCause::ENTRIES,
    OverrideCause::ENTRIES,
    ConnectCause::ENTRIES,
    UnitCause::ENTRIES,
    ClockCause::ENTRIES,
    LoweringCause::ENTRIES,
    StructureCause::ENTRIES,
    CodegenCause::ENTRIES,
    RunCause::ENTRIES,
    PlanCause::ENTRIES,
    DesignCause::ENTRIES,
    RecordingCause::ENTRIES,
    CatalogueCause::ENTRIES,
    MeasureCause::ENTRIES,
    FmuCause::ENTRIES,
    TomlCause::ENTRIES,
    TestCause::ENTRIES,
    QuantityCause::ENTRIES,
];

/// All causes, by code.
pub fn entries() -> impl Iterator<Item = &'static Entry> {
    let mut all: Vec<&Entry> = STAGES.iter().copied().flatten().collect();
    all.sort_by_key(|entry| entry.code);
    all.into_iter()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::base::specification;

    #[test]
    fn codes_are_unique() {
        let codes: Vec<&str> = entries().map(|entry| entry.code).collect();
        let twice: Vec<_> = codes.windows(2).filter(|pair| pair[0] == pair[1]).collect();
        assert!(twice.is_empty(), "{twice:?}");
        assert!(codes.len() > 100, "only {} causes", codes.len());
    }

    #[test]
    fn sections_exist_in_the_specification() {
        let wrong: Vec<_> = entries()
            .filter(|e| !e.section.is_empty() && specification::title(e.section).is_none())
            .map(|e| format!("{}: section {}", e.code, e.section))
            .collect();
        assert!(wrong.is_empty(), "{wrong:?}");
    }

    #[test]
    fn summaries_are_sentences() {
        for entry in entries() {
            let summary = entry.summary;
            assert!(summary.ends_with('.') && summary.len() > 10, "{}: {summary}", entry.code);
        }
    }

    #[test]
    fn every_code_of_the_source_is_registered() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let known: BTreeSet<String> = entries().map(|e| e.code.to_owned()).collect();
        let unknown: Vec<_> = codes(&folder).difference(&known).cloned().collect();
        assert!(unknown.is_empty(), "not in the registry: {unknown:?}");
    }

    /// The codes in the files of a folder, outside of comments.
    fn codes(folder: &Path) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        for entry in fs::read_dir(folder).expect("a folder of the source").flatten() {
            let path = entry.path();
            if path.is_dir() {
                found.extend(codes(&path));
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).expect("a source file");
                let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
                let words = lines.flat_map(|line| line.split(|c: char| !c.is_alphanumeric()));
                let is_code = |word: &&str| {
                    word.len() == 6
                        && word.strip_prefix("MO").is_some_and(|n| n.parse::<u16>().is_ok())
                };
                found.extend(words.filter(is_code).map(str::to_owned));
            }
        }
        found
    }
}
