//! Every example compiles, runs to its end, and says nothing it should not.

use std::path::Path;

use super::door::Case;

#[test]
fn every_example_runs_to_its_end() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("examples").flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|e| e != "mol") {
            continue;
        }
        let compiled = Case::file(&path).compile();
        let stop = compiled.program.blocks.dae.experiment.stop.expect("an experiment annotation");
        let trajectory = compiled.run();
        assert_eq!(trajectory.time.last(), Some(&stop), "{}", path.display());
        count += 1;
    }
    assert_eq!(count, 7, "an example was added or removed: change this number");
}
