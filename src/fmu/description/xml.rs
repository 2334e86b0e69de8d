//! XML as text.

/// A text with elements, indented.
#[derive(Default)]
pub(in crate::fmu) struct Xml {
    pub(in crate::fmu) out: String,
    depth: usize,
}

impl Xml {
    fn begin(&mut self, element: &str, attributes: &[(&str, &str)]) {
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
        self.out.push('<');
        self.out.push_str(element);
        for (name, value) in attributes {
            self.out.push_str(&format!(" {name}=\"{}\"", escaped(value)));
        }
    }

    /// Begins an element that has others.
    pub(in crate::fmu) fn open(&mut self, element: &str, attributes: &[(&str, &str)]) {
        self.begin(element, attributes);
        self.out.push_str(">\n");
        self.depth += 1;
    }

    /// An element without others.
    pub(in crate::fmu) fn empty(&mut self, element: &str, attributes: &[(&str, &str)]) {
        self.begin(element, attributes);
        self.out.push_str("/>\n");
    }

    /// Ends an element.
    pub(in crate::fmu) fn close(&mut self, element: &str) {
        self.depth -= 1;
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
        self.out.push_str(&format!("</{element}>\n"));
    }

    /// An element around others; nothing if there are none.
    pub(in crate::fmu) fn list<T>(
        &mut self,
        element: &str,
        items: Vec<T>,
        each: impl Fn(&mut Xml, T),
    ) {
        if items.is_empty() {
            return;
        }
        self.open(element, &[]);
        for item in items {
            each(self, item);
        }
        self.close(element);
    }

    pub(in crate::fmu) fn scalar(
        &mut self,
        name: &str,
        reference: &str,
        description: Option<&str>,
        shared: &[(&'static str, String)],
        element: &str,
        typed: &[(&'static str, String)],
    ) {
        let mut list = vec![("name", name), ("valueReference", reference)];
        list.extend(description.map(|text| ("description", text)));
        list.extend(shared.iter().map(|(n, v)| (*n, v.as_str())));
        self.open("ScalarVariable", &list);
        let typed: Vec<(&str, &str)> = typed.iter().map(|(n, v)| (*n, v.as_str())).collect();
        self.empty(element, &typed);
        self.close("ScalarVariable");
    }
}

/// A text as the value of an attribute; characters that XML does not allow are left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push_str("&#10;"),
            '\t' => out.push_str("&#9;"),
            c if c < ' ' || c == '\u{fffe}' || c == '\u{ffff}' => {}
            c => out.push(c),
        }
    }
    out
}
