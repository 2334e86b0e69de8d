//! Throughput of the parser on a synthetic library, in bytes of source per second.

use std::fmt::Write;

use mocc::base::diag::Problems;
use mocc::base::source::FileId;
use mocc::parse::grammar::parse;

fn main() {
    divan::main();
}

/// A package of `n` models, each of 16 lines.
fn library(n: usize) -> String {
    let mut text = String::from("package Library\n");
    for i in 0..n {
        let _ = write!(
            text,
            "  model Valve{i} \"A valve with two ports\"
    extends Interfaces.TwoPort(redeclare package Medium = Media.Air, p(start = 1e5));
    parameter Real k(min = 0, unit = \"m3/s\") = 2.5e-3 \"Flow coefficient\" annotation(Dialog(tab = \"A\"));
    Real x[3](each start = 0, each fixed = true), y;
    // The state follows the signal.
  equation
    der(x[1]) = -k*(x[1] - u)^2 + sin(2*Modelica.Constants.pi*f*time);
    x[2:3] = {{if x[1] > 0 and not closed then a.b[i].c else 0.5*x[1] for i in 1:2}};
    when y > 0.5 then
      reinit(x[1], pre(x[1]) + 1);
    end when;
    connect(a.flange, b.flange) annotation(Line(points = {{{{-60, 0}}, {{-20, 0}}}}, color = {{0, 127, 255}}));
    y = noEvent(max(x[1], 0.0)) \"Clipped\";
  end Valve{i};\n\n"
        );
    }
    text + "end Library;\n"
}

#[divan::bench(args = [100, 10_000], sample_count = 10)]
fn parse_library(bencher: divan::Bencher<'_, '_>, models: usize) {
    let text = library(models);
    bencher.counter(divan::counter::BytesCount::of_str(&text)).bench(|| {
        let mut problems = Problems::new();
        let file = parse(FileId(0), &text, &mut problems);
        assert!(problems.is_empty());
        file
    });
}
