//! External functions that are computed without their C: random numbers, spectra, files of data.

use super::door::{Case, Reading, Scratch, assert_close, suite_model};
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
    let text = &suite_model("external/random/xorshift64star_and_xorshift128plus");
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
    let text = &suite_model("external/random/xorshift1024star");
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
    let text = &suite_model("external/files/matrix_from_a_file");
    let path = file.to_str().expect("UTF-8").replace('\\', "\\\\");
    // A model reads what lies beside it.
    let model = scratch.file("model.mo", &text.replace("FILE", &path));
    let run = Case::file(model).stop(2.0).run();
    assert_close(run.last("y[1]"), 1.0 + 5.0 - 6.0, 1e-14);
    assert_close(run.last("y[2]"), 0.4 + 10.0 + 12.0, 1e-14);
}

/// The generator that keeps its state to itself: of two when-clauses each draws the next numbers, those of
/// one instant in order, after the one that is drawn at the start. By xorshift1024* itself.
#[test]
fn hidden_random_numbers_follow_each_other() {
    let words: [i32; 32] = std::array::from_fn(|k| (k as i32 + 1) * 1_234_567 - 20_000_000);
    let text = suite_model("external/random/hidden_state");
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
    let file = scratch.file("printing.mo", &suite_model("external/print/values_at_run_time"));
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
