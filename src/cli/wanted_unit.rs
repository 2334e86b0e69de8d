//! The units that `--unit` asks for.

/// The variables and units of an option, each variable once. The error is a message about one that is wanted in two
/// units.
pub fn once_each(units: &[(String, String)]) -> Result<Vec<&(String, String)>, String> {
    let mut out: Vec<&(String, String)> = Vec::new();
    for wanted @ (name, unit) in units {
        match out.iter().find(|(known, _)| known == name) {
            None => out.push(wanted),
            Some((_, first)) if first == unit => {}
            Some((_, first)) => {
                return Err(format!("--unit: `{name}` is wanted in `{first}` and in `{unit}`"));
            }
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_has_one_unit() {
        let of = |all: &[(&str, &str)]| {
            let all: Vec<_> = all.iter().map(|(n, u)| ((*n).to_owned(), (*u).to_owned())).collect();
            once_each(&all).map(|found| found.len())
        };
        assert_eq!(of(&[("p", "bar"), ("q", "bar"), ("p", "bar")]), Ok(2));
        let message = "--unit: `p` is wanted in `bar` and in `kPa`";
        assert_eq!(of(&[("p", "bar"), ("p", "kPa")]), Err(message.to_owned()));
    }
}
