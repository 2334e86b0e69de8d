//! `mocc doc`: pages of libraries.

use std::collections::BTreeSet;
use std::fs;

use super::door::Scratch;
use super::program::mocc;

const LIBRARY: &str = "package Lib \"A library\"
  type Stiffness = Real(unit = \"N/m\");
  model Spring \"A <spring>\"
    // It pulls back.
    parameter Stiffness c = 2e3 \"Stiffness\";
    parameter Real s_0(unit = \"m\") = 0;
    Real tau_1, f;
    Real s(start = 1, fixed = true);
  initial equation
    tau_1 = 1;
  equation
    f = -c*(s - s_0);
    der(s) = sqrt(tau_1)/(1 + s^2);
    der(tau_1) = if s > 1 then 1 else 0;
    assert(s > 0, \"positive\");
  end Spring;
  model Two
    extends Spring;
    Spring other;
  end Two;
end Lib;
";

/// What links of a page lead to.
fn targets(page: &str) -> BTreeSet<String> {
    let all = page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next());
    all.filter(|t| !t.starts_with('#')).map(str::to_owned).collect()
}

#[test]
fn a_page_shows_units_equations_and_users() {
    let folder = Scratch::new();
    folder.file("lib.mo", LIBRARY);
    let ended = mocc(folder.path(), &["doc", "lib.mo", "-o", "pages"]);
    assert_eq!(
        (ended.status, ended.out.as_str()),
        (0, "wrote 5 pages, pages/index.html\n"),
        "{}",
        ended.err
    );
    let read =
        |name: &str| fs::read_to_string(folder.path().join("pages").join(name)).expect("a page");
    let page = read("Lib.Spring.html");
    assert!(page.contains("A &lt;spring&gt;") && page.contains("It pulls back."));
    // The unit of the type, and the own one.
    assert!(page.contains("<code>2e3</code></td><td class=\"l\">N/m</td>"), "the unit of the type");
    assert!(page.contains("<td class=\"l\">m</td>"), "the own unit");
    // - c (s - s_0), a derivative with a dot, a root over a sum, an index.
    for part in [
        "<mo>−</mo><mi>c</mi><mo>·</mo><mrow><mo>(</mo><mi>s</mi><mo>−</mo><msub><mi>s</mi><mtext>0</mtext></msub><mo>)</mo></mrow>",
        "<mover accent=\"true\"><mrow><mi>s</mi></mrow><mo>˙</mo></mover>",
        "<mfrac><mrow><msqrt><msub><mi>τ</mi><mtext>1</mtext></msub></msqrt></mrow>",
        "<msup><mrow><mi>s</mi></mrow><mrow><mn>2</mn></mrow></msup>",
        "initially",
    ] {
        assert!(page.contains(part), "no {part}");
    }
    assert!(!page.contains("<mi>assert</mi>"), "an assertion is no equation");
    let used = page.split_once("Used by").expect("users").1;
    assert!(used.contains("href=\"Lib.Two.html\""));
    for name in fs::read_dir(folder.path().join("pages")).expect("pages") {
        let page = fs::read_to_string(name.expect("a file").path()).expect("a page");
        for target in targets(&page) {
            assert!(folder.path().join("pages").join(&target).is_file(), "{target}");
        }
    }
}

#[test]
fn the_shipped_library_has_pages() {
    let folder = Scratch::new();
    let ended = mocc(folder.path(), &["doc", "-o", "pages", "--quiet"]);
    assert_eq!((ended.status, ended.out.as_str()), (0, ""), "{}", ended.err);
    let mut count = 0;
    for name in fs::read_dir(folder.path().join("pages")).expect("pages") {
        let page = fs::read_to_string(name.expect("a file").path()).expect("a page");
        count += 1;
        for target in targets(&page) {
            assert!(folder.path().join("pages").join(&target).is_file(), "{target}");
        }
    }
    assert!(count > 200, "{count}");
}

#[test]
fn packages_in_packages_keep_their_names() {
    let folder = Scratch::new();
    folder.file("A/package.mo", "package A end A;");
    folder.file("A/B/package.mo", "within A; package B \"inner\" end B;");
    folder.file("A/B/C.mo", "within A.B; model C Real x = 1; end C;");
    let ended = mocc(folder.path(), &["doc", "A/B", "-o", "pages"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(folder.path().join("pages/A.B.C.html").is_file(), "{}", ended.out);
}

#[test]
fn wrong_use_is_refused() {
    let folder = Scratch::new();
    folder.file("empty.mo", "");
    let cases: [(&[&str], &str); 4] = [
        (&["doc", "none", "-o", "pages"], "cannot read none"),
        (&["doc", "empty.mo", "-o", "pages"], "has no Modelica classes"),
        (&["doc", "--lib", "none", "-o", "pages"], "there is no folder `none`"),
        (&["doc"], "--output"),
    ];
    for (arguments, message) in cases {
        let ended = mocc(folder.path(), arguments);
        assert_eq!(ended.status, 2, "{arguments:?}");
        assert!(ended.err.contains(message), "{}", ended.err);
        assert!(!folder.path().join("pages").exists());
    }
}
