//! The classes of a library: names as they are written in a class to full names, units of types, and who uses whom.

use crate::base::index::FastMap;
use crate::driver::catalogue::Parsed;
use crate::ir::ast::{
    ArgumentKind, Class, ClassBody, ElementKind, ExprKind, ImportForm, Modification, Path,
};

/// Types that are aliases of aliases.
const DEEPEST: usize = 12;

/// All classes that pages may refer to.
pub struct Classes {
    /// Those with pages first.
    pub all: Vec<Parsed>,
    /// Number of classes with pages.
    pub count: usize,
    by_name: FastMap<String, usize>,
    used_by: Vec<Vec<usize>>,
}

impl Classes {
    /// `own` get pages, `others` are known by name only.
    pub fn new(own: Vec<Parsed>, others: Vec<Parsed>) -> Classes {
        let count = own.len();
        let mut all = own;
        all.extend(others);
        let mut by_name = FastMap::default();
        for (k, parsed) in all.iter().enumerate() {
            by_name.entry(parsed.name.clone()).or_insert(k);
        }
        let mut classes = Classes { all, count, by_name, used_by: Vec::new() };
        let mut used_by = vec![Vec::new(); classes.all.len()];
        for k in 0..classes.all.len() {
            for used in classes.uses(k) {
                if used != k && used_by[used].last() != Some(&k) {
                    used_by[used].push(k);
                }
            }
        }
        classes.used_by = used_by;
        classes
    }

    /// The class with a page around the class of this name.
    pub fn outer(&self, name: &str) -> Option<usize> {
        let (outer, _) = name.rsplit_once('.')?;
        self.by_name.get(outer).copied().filter(|k| *k < self.count)
    }

    /// The classes with components of this class, or that extend it.
    pub fn used_by(&self, k: usize) -> &[usize] {
        &self.used_by[k]
    }

    fn uses(&self, k: usize) -> Vec<usize> {
        let class = &self.all[k].class;
        let names: Vec<&Path> = match &class.body {
            ClassBody::Short(short) => vec![&short.base],
            ClassBody::Long(composition) => composition
                .elements
                .iter()
                .filter_map(|e| match &e.kind {
                    ElementKind::Components(clause) => Some(&clause.type_name),
                    ElementKind::Extends(extends) => Some(&extends.base),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        };
        let mut out: Vec<usize> = names.iter().filter_map(|path| self.find(k, path)).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    /// The class that a name in the class `k` means: in the packages around it, from the innermost, and their imports.
    pub fn find(&self, k: usize, path: &Path) -> Option<usize> {
        let written = path.to_string();
        let written = written.strip_prefix('.').unwrap_or(&written);
        let (first, rest) = written.split_once('.').map_or((written, ""), |(a, b)| (a, b));
        let mut scope = self.all[k].name.as_str();
        loop {
            let full =
                if scope.is_empty() { written.to_owned() } else { format!("{scope}.{written}") };
            if let Some(found) = self.by_name.get(&full) {
                return Some(*found);
            }
            if let Some(target) =
                self.by_name.get(scope).and_then(|s| imported(&self.all[*s].class, first))
            {
                let full = if rest.is_empty() { target } else { format!("{target}.{rest}") };
                if let Some(found) = self.by_name.get(&full) {
                    return Some(*found);
                }
            }
            if scope.is_empty() {
                return None;
            }
            scope = scope.rsplit_once('.').map_or("", |(outer, _)| outer);
        }
    }

    /// The unit of a component of class `k`: of its modification, else of its type.
    pub fn unit(&self, k: usize, type_name: &Path, own: Option<&Modification>) -> String {
        if let Some(unit) = own.and_then(unit_of) {
            return unit;
        }
        let mut at = self.find(k, type_name);
        for _ in 0..DEEPEST {
            let Some(here) = at else { break };
            let ClassBody::Short(short) = &self.all[here].class.body else { break };
            if let Some(unit) = short.modification.as_deref().and_then(unit_of) {
                return unit;
            }
            at = self.find(here, &short.base).filter(|next| *next != here);
        }
        String::new()
    }
}

/// The full name that an import of a class gives a name.
fn imported(class: &Class, name: &str) -> Option<String> {
    let ClassBody::Long(composition) = &class.body else { return None };
    composition.elements.iter().find_map(|e| {
        let ElementKind::Import(import) = &e.kind else { return None };
        let path = import.path.to_string();
        match &import.form {
            ImportForm::Qualified => (path.rsplit('.').next() == Some(name)).then_some(path),
            ImportForm::Renamed(own) => (*own.name == *name).then_some(path),
            ImportForm::List(names) => {
                names.iter().any(|n| *n.name == *name).then(|| format!("{path}.{name}"))
            }
            ImportForm::All => None,
        }
    })
}

fn unit_of(modification: &Modification) -> Option<String> {
    modification.args.iter().find_map(|argument| {
        let ArgumentKind::Element { path, modification: Some(inner), .. } = &argument.kind else {
            return None;
        };
        match inner.binding.as_deref().map(|e| &e.kind) {
            Some(ExprKind::String(unit)) if path.to_string() == "unit" => Some(unit.to_string()),
            _ => None,
        }
    })
}
