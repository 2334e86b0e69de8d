//! Adding a built-in function takes one row of the table in `src/engine/ir/builtin.rs`: nothing else names it.

use mocc::ir::expr::{Binary, Unary};
use mocc::ir::external::Externals;

use super::architecture::{paths, program, tokens, without_tests};
use super::door::{Case, Reading};

const TABLE: &str = "src/engine/ir/builtin.rs";

fn names() -> Vec<&'static str> {
    let unary = Unary::TABLE.iter().flat_map(|op| op.called_names());
    unary.chain(Binary::TABLE.iter().flat_map(|op| op.called_names())).copied().collect()
}

/// Types of the language, and words of messages, that are also names of functions.
const WORDS: [&str; 2] = ["Real", "Integer"];

#[test]
fn the_name_of_a_function_occurs_in_the_table_alone() {
    let mut found = Vec::new();
    for file in program() {
        let tokens = without_tests(tokens(&file));
        for name in names().into_iter().filter(|name| !WORDS.contains(name)) {
            let literal = format!("\"{name}\"");
            let count = tokens.iter().filter(|(_, token)| *token == literal).count();
            let expected = usize::from(file == TABLE);
            if count != expected {
                found.push(format!("{file}: \"{name}\" occurs {count} times, not {expected}"));
            }
        }
    }
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

/// Operators that some stage treats apart: operators of algebra, and functions with an identity that is used.
const SPECIAL: [&str; 30] = [
    "Neg",
    "Not",
    "Sin",
    "Cos",
    "Sqrt",
    "Abs",
    "Sign",
    "ToInteger",
    "Ordinal",
    "Floor",
    "Ceil",
    "Log",
    "Log10",
    "Exp",
    "External",
    "Carried",
    "Text",
    "Add",
    "Sub",
    "Mul",
    "Div",
    "Pow",
    "And",
    "Or",
    "Min",
    "Max",
    "Atan2",
    "Quotient",
    "Mod",
    "Rem",
];

#[test]
fn no_stage_matches_on_an_ordinary_function() {
    let mut found = Vec::new();
    let facts = ["TABLE", "called"];
    for file in program().into_iter().filter(|file| file != TABLE) {
        for (line, path) in paths(&without_tests(tokens(&file))) {
            let [.., of, op] = path.as_slice() else { continue };
            let relation =
                ["Less", "Greater", "Equal", "NotEqual"].iter().any(|r| op.starts_with(r));
            let ordinary =
                !SPECIAL.contains(&op.as_str()) && !facts.contains(&op.as_str()) && !relation;
            if (of == "Unary" || of == "Binary") && ordinary {
                found.push(format!("{file}:{line}: {of}::{op}"));
            }
        }
    }
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn modelica_calls_every_function_by_its_name() {
    for op in Unary::TABLE {
        for name in op.called_names() {
            // An argument that is known at run time only, in every domain.
            let argument = if *op == Unary::Ordinal { "time > 0.5" } else { "0.25 + time / 2" };
            let run =
                Case::text(&format!("model M Real y = {name}({argument}); end M;")).stop(1.0).run();
            let x = if *op == Unary::Ordinal { 1.0 } else { 0.75 };
            assert_eq!(
                run.last("y"),
                mocc::symbolic::eval::unary(*op, x, &Externals::EMPTY),
                "{name}"
            );
        }
    }
    for op in Binary::TABLE {
        for name in op.called_names() {
            let text = format!("model M Real y = {name}(2 + time, 0.25 + 1.5 * time); end M;");
            let run = Case::text(&text).stop(1.0).run();
            assert_eq!(
                run.last("y"),
                mocc::symbolic::eval::binary(*op, 3.0, 1.75, &Externals::EMPTY),
                "{name}"
            );
        }
    }
}
