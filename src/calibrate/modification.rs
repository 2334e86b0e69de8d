//! Modifications of a model as source: nested like its components, one per line.

/// A name without its subscripts.
pub fn without_subscripts(name: &str) -> String {
    let mut depth = 0;
    let outside = |c: &char| {
        depth += i32::from(*c == '[');
        let out = depth == 0;
        depth -= i32::from(*c == ']');
        out
    };
    name.chars().filter(outside).collect()
}

/// The parts of a dotted name; dots in quoted identifiers do not separate.
pub fn parts(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut quoted = false;
    for c in name.chars() {
        quoted ^= c == '\'';
        match (c, out.last_mut()) {
            ('.', _) if !quoted => out.push(String::new()),
            (_, Some(last)) => last.push(c),
            _ => {}
        }
    }
    out
}

/// Modifications by name.
#[derive(Default)]
pub struct Tree {
    children: Vec<(String, Tree)>,
    /// A value and its comment.
    value: Option<(String, String)>,
    /// Words before the name, such as `redeclare model`.
    prefix: String,
}

impl Tree {
    /// True without any modification.
    pub fn is_empty(&self) -> bool {
        self.children.is_empty()
    }

    /// Sets the value at a path; the comment may be empty.
    pub fn set(&mut self, path: &[String], value: String, comment: String) {
        self.at(path).value = Some((value, comment));
    }

    /// Redeclares the element at a path: a class by its keyword, or a component.
    pub fn redeclare(&mut self, path: &[String], keyword: Option<&str>, class: &str) {
        let element = self.at(path);
        match keyword {
            Some(keyword) => {
                element.prefix = format!("redeclare {keyword} ");
                element.value = Some((class.to_owned(), String::new()));
            }
            None => element.prefix = format!("redeclare {class} "),
        }
    }

    fn at(&mut self, path: &[String]) -> &mut Tree {
        let Some((first, rest)) = path.split_first() else { return self };
        let at = self.children.iter().position(|(name, _)| name == first).unwrap_or_else(|| {
            self.children.push((first.clone(), Tree::default()));
            self.children.len() - 1
        });
        self.children[at].1.at(rest)
    }

    /// Prints one line for each modification, followed by its comment.
    pub fn print(&self, indent: usize, out: &mut String) {
        for (i, (name, node)) in self.children.iter().enumerate() {
            let comma = if i + 1 < self.children.len() { "," } else { "" };
            out.push_str(&format!("{:indent$}{}{name}", "", node.prefix));
            if !node.children.is_empty() {
                out.push_str("(\n");
                node.print(indent + 2, out);
                out.push_str(&format!("{:indent$})", ""));
            }
            match &node.value {
                Some((value, comment)) => {
                    let mark = if comment.is_empty() { "" } else { " // " };
                    out.push_str(&format!(" = {value}{comma}{mark}{comment}\n"));
                }
                None => out.push_str(&format!("{comma}\n")),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_split_at_dots_outside_quotes() {
        assert_eq!(parts("a.'b.c'.d"), ["a", "'b.c'", "d"]);
        assert_eq!(without_subscripts("a[2].b[1, 3].c"), "a.b.c");
    }

    #[test]
    fn a_redeclared_component_keeps_its_modifications() {
        let mut root = Tree::default();
        root.set(&parts("motor.brake.M"), "2.0".into(), String::new());
        root.redeclare(&parts("motor.brake"), None, "Drives.Brake");
        root.redeclare(&parts("Friction"), Some("model"), "Drives.Stribeck");
        let mut text = String::new();
        root.print(0, &mut text);
        let expected = "motor(\n  redeclare Drives.Brake brake(\n    M = 2.0\n  )\n),\n\
                        redeclare model Friction = Drives.Stribeck\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn modifications_are_nested() {
        let mut root = Tree::default();
        root.set(&parts("m"), "1.0".into(), "kg".into());
        root.set(&parts("spring.k"), "2.0".into(), "+- 1".into());
        root.set(&parts("spring.x.start"), "3.0".into(), "m".into());
        let mut text = String::new();
        root.print(2, &mut text);
        let expected = "  m = 1.0, // kg\n  spring(\n    k = 2.0, // +- 1\n    x(\n      start = 3.0 // m\n    )\n  )\n";
        assert_eq!(text, expected);
    }
}
