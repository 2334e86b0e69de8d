//! External functions that are computed without their C: random numbers, spectra, files of data.

use super::door::{Case, Reading, Scratch, assert_close};
use super::program::mocc;

/// The halves of a word as a model holds them.
fn halves(word: u64) -> [f64; 2] {
    [word as u32, (word >> 32) as u32].map(|half| f64::from(half as i32))
}

fn fraction(word: u64) -> f64 {
    word as i64 as f64 / 2.0_f64.powi(64) + 0.5
}

/// The generator xorshift64* of its paper, in plain words of 64 bits.
fn star(mut x: u64) -> u64 {
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    x.wrapping_mul(2_685_821_657_736_338_717)
}

#[test]
fn random_numbers_are_drawn_at_events() {
    let text = "package P
           function star
             input Integer before[2];
             output Integer after[2];
             output Real x;
           external \"C\" ModelicaRandom_xorshift64star(before, after, x);
           end star;
           function plus
             input Integer before[4];
             output Integer after[4];
             output Real x;
           external \"C\" ModelicaRandom_xorshift128plus(before, after, x);
           end plus;
           model Draws
             parameter Integer seed(fixed = false);
             parameter Integer first = seed + 1;
             Integer s[2];
             Integer t[4](start = {1, 2, 3, 4}, each fixed = true);
             discrete Real x;
             discrete Real y(start = 0, fixed = true);
           initial equation
             seed = 4;
             pre(s) = {first, -7};
             pre(x) = 0;
           equation
             when sample(0.1, 0.1) then
               (s, x) = star(pre(s));
               (t, y) = plus(pre(t));
             end when;
           end Draws;
         end P;";
    let run = Case::text(text).stop(0.35).run();
    let mut word = u64::from(-7_i32 as u32) << 32 | 5;
    let mut pair = [2_u64 << 32 | 1, 4 << 32 | 3];
    for _ in 0..3 {
        word = star(word);
        let [mut a, b] = pair;
        a ^= a << 23;
        pair = [b, (a ^ b ^ (a >> 17) ^ (b >> 26)).wrapping_add(b)];
    }
    assert_eq!([run.last("s[1]"), run.last("s[2]")], halves(word));
    assert_eq!([run.last("t[3]"), run.last("t[4]")], halves(pair[1]));
    assert_close(run.last("x"), fraction(word), 1e-15);
    assert_close(run.last("y"), fraction(pair[1]), 1e-15);
}

/// The generator xorshift1024* of its paper, in plain words of 64 bits: sixteen of them, and the number
/// of the one that was drawn last.
fn star_of_many(words: &mut [u64; 16], last: &mut usize) -> u64 {
    let old = words[*last];
    *last = (*last + 1) % 16;
    let mut x = words[*last];
    x ^= x << 31;
    words[*last] = x ^ old ^ (x >> 11) ^ (old >> 30);
    words[*last].wrapping_mul(1_181_783_497_276_652_981)
}

#[test]
fn a_long_state_goes_round() {
    let text = "package P
           function draw
             input Integer before[33];
             output Integer after[33];
             output Real x;
           external \"C\" ModelicaRandom_xorshift1024star(before, after, x);
           end draw;
           model Draws
             Integer s[33](start = {if k == 33 then 14 else 65537*k - 99 for k in 1:33}, each fixed = true);
             discrete Real x(start = 0, fixed = true);
           equation
             when sample(0.1, 0.1) then
               (s, x) = draw(pre(s));
             end when;
           end Draws;
         end P;";
    // More draws than words: each is used again.
    let run = Case::text(text).stop(2.05).run();
    let half = |k: u64| u64::from((65537 * k - 99) as u32);
    let mut words: [u64; 16] =
        std::array::from_fn(|k| half(2 * k as u64 + 2) << 32 | half(2 * k as u64 + 1));
    let mut last = 14;
    let drawn = (0..20).map(|_| star_of_many(&mut words, &mut last)).last().expect("twenty");
    for (k, word) in words.into_iter().enumerate() {
        let found = [1, 2].map(|half| run.last(&format!("s[{}]", 2 * k + half)));
        assert_eq!(found, halves(word), "word {k}");
    }
    assert_eq!(run.last("s[33]"), last as f64);
    assert_close(run.last("x"), fraction(drawn), 1e-15);
}

#[test]
fn a_matrix_is_read_from_a_file() {
    let scratch = Scratch::new();
    let file = scratch.file("data.txt", "#1\ndouble gains(2, 3)\n1 2.5 -3 # first\n4e-1, 5, 6\n");
    let text = "package P
           function sizes
             input String file;
             input String name;
             output Integer n[2];
           external \"C\" ModelicaIO_readMatrixSizes(file, name, n);
           end sizes;
           function gains
             input String file;
             input String name;
             input Integer rows;
             input Integer columns;
             output Real m[rows, columns];
           external \"C\" ModelicaIO_readRealMatrix(file, name, m, rows, columns, false);
           end gains;
           model Reads
             parameter String file = \"FILE\";
             parameter Integer n[2] = sizes(file, \"gains\");
             parameter Real m[n[1], n[2]] = gains(file, \"gains\", n[1], n[2]);
             Real y[n[1]] = m*{1, 2, time};
           end Reads;
         end P;";
    let path = file.to_str().expect("UTF-8").replace('\\', "\\\\");
    let run = Case::text(&text.replace("FILE", &path)).stop(2.0).run();
    assert_close(run.last("y[1]"), 1.0 + 5.0 - 6.0, 1e-14);
    assert_close(run.last("y[2]"), 0.4 + 10.0 + 12.0, 1e-14);
}

#[test]
fn a_spectrum_is_found_of_samples() {
    let run = Case::text(
        "package P
           function spectrum
             input Real u[:];
             output Integer info;
             output Real amplitudes[div(size(u, 1), 2) + 1];
             output Real phases[div(size(u, 1), 2) + 1];
           protected
             Real work[3*size(u, 1) + 2*(div(size(u, 1), 2) + 1)];
           external \"C\" info = ModelicaFFT_kiss_fftr(u, size(u, 1), work, size(work, 1), amplitudes, phases);
           end spectrum;
           model Sampled
             Integer n(start = 0, fixed = true);
             Real u[12](each start = 0, each fixed = true);
             Real a[7](each start = 0, each fixed = true);
             Real p[7](each start = 0, each fixed = true);
             Integer info(start = -1, fixed = true);
           algorithm
             when sample(0, 0.05) then
               n := pre(n) + 1;
               if n <= 12 then
                 u[n] := 3*cos(2*3.14159265358979*(n - 1)/4 + 0.5);
               end if;
             end when;
             when n >= 12 then
               (info, a, p) := spectrum(u);
             end when;
           end Sampled;
         end P;",
    )
    .run();
    assert_eq!(run.last("info"), 0.0);
    // Three waves in twelve samples; the library divides by the number of terms, 7, instead of 6.
    assert_close(run.last("a[4]"), 3.0 * 6.0 / 7.0, 1e-12);
    assert_close(run.last("p[4]"), 0.5, 1e-12);
    for k in [1, 2, 3, 5, 6, 7] {
        assert!(run.last(&format!("a[{k}]")).abs() < 1e-12, "{k}");
    }
}

/// Their documentation: where nothing is found the position stays, and unsigned numbers have no sign.
#[test]
fn texts_are_scanned_from_a_position_on() {
    let text = "package P
           function integer_at
             input String text;
             input Integer start;
             input Boolean unsigned;
             output Integer next;
             output Integer number;
           external \"C\" ModelicaStrings_scanInteger(text, start, unsigned, next, number);
           end integer_at;
           function name_at
             input String text;
             input Integer start;
             output Integer next;
             output String name;
           external \"C\" ModelicaStrings_scanIdentifier(text, start, next, name);
           end name_at;
           function hash
             input String text;
             output Integer number;
           external \"C\" number = ModelicaStrings_hashString(text);
           end hash;
           model Scan
             parameter Integer sign = integer_at(\"x = -12\", 4, false);
             parameter Integer none = integer_at(\"x = -12\", 4, true);
             parameter Integer name = name_at(\"2*(b1)\", 4);
             parameter Integer no_name = name_at(\"2*(b1)\", 3);
             Real y[5] = {sign, none, name, no_name, hash(\"Noise.source\")};
           end Scan;
         end P;";
    let run = Case::text(text).run();
    // The last one by an independent program for Partow's hash.
    for (k, expected) in [8.0, 4.0, 6.0, 3.0, 1009890721.0].into_iter().enumerate() {
        assert_close(run.last(&format!("y[{}]", k + 1)), expected, 0.0);
    }
}

/// The generator that keeps its state to itself: of two when-clauses each draws the next numbers, those of
/// one instant in order, after the one that is drawn at the start. By xorshift1024* itself.
#[test]
fn hidden_random_numbers_follow_each_other() {
    let words: [i32; 32] = std::array::from_fn(|k| (k as i32 + 1) * 1_234_567 - 20_000_000);
    let state = words.map(|w| w.to_string()).join(", ");
    let text = format!(
        "package P
           function begin
             input Integer seed[33];
             output Integer id;
           protected
             function set
               input Integer seed[33];
               input Integer id;
             external \"C\" ModelicaRandom_setInternalState_xorshift1024star(seed, 33, id);
             end set;
           algorithm
             id := 7;
             set(seed, id);
           end begin;
           impure function draw
             input Integer id;
             output Real y;
           external \"C\" y = ModelicaRandom_impureRandom_xorshift1024star(id);
           end draw;
           model Draws
             parameter Integer id(fixed = false);
             parameter Real first = draw(id);
             Real seen = first;
             discrete Real a, b, c;
           initial equation
             id = begin({{{state}, 3}});
           equation
             when sample(0.1, 0.2) then
               a = draw(id);
               b = draw(id) + draw(id);
             end when;
             when sample(0.1, 0.1) then
               c = draw(id);
             end when;
           end Draws;
         end P;"
    );
    let mut word: [u64; 16] = std::array::from_fn(|k| {
        u64::from(words[2 * k + 1] as u32) << 32 | u64::from(words[2 * k] as u32)
    });
    let mut at = 3;
    let mut draw = || {
        let (old, next) = (word[at], (at + 1) % 16);
        let mut x = word[next] ^ word[next] << 31;
        x ^= x >> 11 ^ old ^ old >> 30;
        (word[next], at) = (x, next);
        x.wrapping_mul(1_181_783_497_276_652_981) as i64 as f64 / 2.0_f64.powi(64) + 0.5
    };
    let first = draw();
    // At 0.1 both clauses draw, at 0.2 the second one, at 0.3 both.
    let _ = [draw(), draw(), draw(), draw(), draw()];
    let (a, b, c) = (draw(), draw() + draw(), draw());
    let run = Case::text(&text).stop(0.35).run();
    for (name, expected) in [("seen", first), ("a", a), ("b", b), ("c", c)] {
        assert_close(run.last(name), expected, 1e-15);
    }
}

/// What a model prints appears as it runs, with the values of that instant.
#[test]
fn a_model_prints() {
    let scratch = Scratch::new();
    let file = scratch.file(
        "printing.mo",
        "model Printing
           function print
             input String string;
             input String fileName = \"\";
           external \"C\" ModelicaInternal_print(string, fileName);
           end print;
           Real x(start = 0, fixed = true);
           Integer n(start = 0, fixed = true);
         initial algorithm
           print(\"begins at \" + String(x));
         equation
           der(x) = 2;
           when sample(0.25, 0.5) then
             n = pre(n) + 1;
             print(String(n) + \": \" + String(x, format = \"6.3f\") + \" \" + String(n > 1));
           end when;
           when terminal() then
             print(\"ends at \" + String(x, significantDigits = 3), \"log.txt\");
           end when;
           when time > 0.6 then
             assert(x < 1, \"x has become \" + String(x), level = AssertionLevel.warning);
           end when;
         end Printing;",
    );
    let ended = mocc(scratch.path(), &["simulate", file.to_str().expect("UTF-8"), "--stop", "1"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(
        ended.out.starts_with("begins at 0\n1:  0.500 false\n2:  1.500 true\n"),
        "{}",
        ended.out
    );
    assert!(ended.err.contains("at time 0.6 s: x has become 1.2\n"), "{}", ended.err);
    let log = std::fs::read_to_string(scratch.path().join("log.txt")).expect("a file");
    assert_eq!(log, "ends at 2\n");
}
