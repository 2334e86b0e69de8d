//! What a cycle of the 5/2-way valve costs in units of its evaluations, and what recordings, derivatives and measures
//! cost in units of a cycle: ratios of times of one run, which do not depend on the machine as the times do.

use std::path::Path;
use std::time::Instant;

use mocc::base::diag::Problems;
use mocc::base::source::SourceMap;
use mocc::calibrate::data::{self, Split};
use mocc::calibrate::plan_file;
use mocc::calibrate::problem::{Problem, record_signals};
use mocc::codegen::recording;
use mocc::driver::compile::{Request, Session};
use mocc::ir::program::Program;
use mocc::ir::trajectory::Trajectory;
use mocc::runtime::jit::tiering::Execution;
use mocc::runtime::machine::Machine;
use mocc::simulate::run::{Statistics, simulate_to};
use mocc::simulate::settings::Settings;

/// Repetitions of a cycle, of which the fastest counts.
const CYCLES: usize = 60;
/// Repetitions of all recordings.
const ROUNDS: usize = 3;

fn main() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/valve52.mol");
    let mut session = Session::default();
    let request = Request { file: Some(file), ..Request::default() };
    let whole = session.compile(&request).expect("a program");
    let mut one = whole.clone();
    recording::only(&mut one, |name| name == "spool.s");

    let all = Cycle::of(&whole, &session.sources);
    let single = Cycle::of(&one, &session.sources);
    let evaluation = evaluation(&whole, &all);
    println!("anchor: an evaluation of the derivatives, {:.3} us", evaluation * 1e6);
    let share = |t: f64| t / evaluation;
    let Statistics { integration: s, rows, .. } = &single.statistics;
    println!(
        "steps {}, rejected {}, evaluations {}, Jacobians {}, decompositions {}, rows {rows}",
        s.steps,
        s.rejected + s.convergence_failures,
        s.rhs,
        s.jacobians,
        s.decompositions
    );
    println!(
        "cycle, all variables recorded: {:.0} evaluations, {:.2} ms",
        share(all.time),
        all.time * 1e3
    );
    println!(
        "cycle, one variable recorded: {:.0} evaluations, {:.2} ms",
        share(single.time),
        single.time * 1e3
    );
    derivatives();
}

/// A run of one program.
struct Cycle {
    time: f64,
    statistics: Statistics,
    rows: Trajectory,
    execution: Execution,
}

impl Cycle {
    fn of(program: &Program, sources: &SourceMap) -> Cycle {
        let mut settings = Settings::of(&program.blocks.dae.experiment);
        settings.execution = Execution::translated(program);
        let (mut rows, mut statistics) = (Trajectory::default(), Statistics::default());
        let time = fastest(CYCLES, || {
            statistics = simulate_to(program, &settings, sources, &mut rows).expect("a run");
        });
        Cycle { time, statistics, rows, execution: settings.execution }
    }
}

/// The time of an evaluation of the derivatives by machine code, at the rows of a run, s.
fn evaluation(program: &Program, cycle: &Cycle) -> f64 {
    let names = program.blocks.states.iter().map(|s| program.name(s.variable));
    let columns: Vec<_> = names.map(|n| cycle.rows.values(n).expect("a recorded state")).collect();
    let mut machine = Machine::new(program);
    machine.set_execution(&cycle.execution);
    machine.run(&program.tapes.parameters).expect("parameters");
    let (mut states, mut slopes) = (vec![0.0; columns.len()], vec![0.0; columns.len()]);
    let rows = cycle.rows.rows();
    fastest(CYCLES, || {
        for row in 0..rows {
            states.iter_mut().zip(&columns).for_each(|(state, column)| *state = column[row]);
            let _ = machine.derivatives(cycle.rows.time[row], &states, &mut slopes);
        }
    }) / rows as f64
}

/// Residuals of all recordings of the valve, and their derivatives by the twelve free parameters.
fn derivatives() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/valve52.toml");
    let mut session = Session::default();
    let text = std::fs::read_to_string(&path).expect("the plan");
    let plan = plan_file::read(&path, &text, &mut session.sources, &mut session.problems);
    let plan = plan.expect("a plan");
    let data = data::read(&plan, &mut session.problems).expect("recordings");
    let mut program = session.compile(&plan.request(None)).expect("a program");
    record_signals(&mut program, &plan);
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, &plan, &data, &mut problems);
    let problem = problem.expect("a problem");
    let x = problem.start();
    let mut recordings = problem.recordings(Split::Train);
    recordings.extend(problem.recordings(Split::Validation));
    let plain = fastest(ROUNDS, || {
        recordings.iter().for_each(|r| drop(problem.residuals(r, &x).expect("residuals")));
    });
    let differentiated = fastest(ROUNDS, || {
        recordings.iter().for_each(|r| drop(problem.normal_of(r, &x).expect("derivatives")));
    });
    println!("anchor: residuals of {} recordings, {:.2} ms", recordings.len(), plain * 1e3);
    println!(
        "with derivatives by {} parameters: {:.2} times that",
        x.len(),
        differentiated / plain
    );
}

fn fastest(repetitions: usize, mut work: impl FnMut()) -> f64 {
    let once = |_| {
        let started = Instant::now();
        work();
        started.elapsed().as_secs_f64()
    };
    (0..repetitions).map(once).fold(f64::INFINITY, f64::min)
}
