//! Causes found when components are instantiated.

use std::fmt;

use crate::base::cause::causes;
use crate::base::name::Name;
use crate::classes::cause::Incompatibility;

causes! {
    /// Causes found when components are instantiated.
    pub enum InstantiateCause {
        /// The size, condition or class of a component depends on itself.
        error MO0293 StructureCycle { path: String } (section "4.4.3")
            => ("the structure of `{path}` depends on itself"),
            help("break the cycle: give one of the sizes or conditions a value of its own");
        /// The class of a component is partial.
        error MO0208 PartialClass { class: Name, path: String, replaceable: bool }
            (section "4.4.2")
            => ("`{class}` is partial: `{path}` cannot be of this class"),
            help("{}", match replaceable {
                true => "redeclare the component with a class that is not partial",
                false => "use a class that extends it",
            });
        /// The class of a component is a package or function.
        error MO0298 NotAComponentClass { class: Name } (section "4.6")
            => ("`{class}` is a package or a function, not the class of a component"),
            help("declare the component with a model, block, record, connector or type");
        /// A class has a component of its own class.
        error MO0294 ContainsItself { class: Name } (section "5.6.1")
            => ("`{class}` contains itself"),
            help("remove the component: a model cannot hold a component of its own class");
        /// A model has more components than mocc can hold.
        error MO1295 TooManyComponents { path: String, most: usize }
            => ("the model has more than {most} components; {} is one too many", shortened(path)),
            help("check the sizes of arrays of components, and classes that hold two of another, \
                  which holds two of a third, and so on; `--max-size` of `mocc check` and \
                  `mocc simulate` allows more");
        /// Components hold components in very many levels.
        error MO0333 NestedTooDeep { path: String, most: usize }
            => ("components are nested more than {most} levels deep: {}", shortened(path)),
            help("use an array of components, or let classes extend each other");
        /// An `outer` component is modified.
        error MO1219 OuterModified { name: Name } (section "5.4")
            => ("`{name}` is `outer`, and cannot be modified"),
            help("modify the `inner` component that it refers to");
        /// An `inner` component is not a subtype of an `outer` one.
        error MO0267 IncompatibleInner { name: Name, why: InnerMismatch } (section "5.4")
            => ("`outer {name}` is not compatible with its `inner` component: {why}"),
            help("give both the same class, \
                  or the `inner` one a class that extends that of the `outer` one");
    }
}

/// The ends of a path that may be very long.
fn shortened(path: &str) -> String {
    const SHOWN: usize = 20;
    match (path.char_indices().nth(SHOWN), path.char_indices().rev().nth(SHOWN - 1)) {
        (Some((from, _)), Some((to, _))) if from < to => {
            let (begin, end) = (&path[..from], &path[to..]);
            format!("`{} ... {}`", begin.trim_end_matches('.'), end.trim_start_matches('.'))
        }
        _ => format!("`{path}`"),
    }
}

/// Why an `inner` component is not a subtype of an `outer` one.
#[derive(Clone, PartialEq, Debug)]
pub enum InnerMismatch {
    /// The numbers of dimensions differ.
    Rank {
        /// Of the `outer` component.
        outer: usize,
        /// Of the `inner` component.
        inner: usize,
    },
    /// The classes are not compatible.
    Class(Incompatibility),
    /// The sizes differ.
    Size {
        /// Of the `outer` component.
        outer: Vec<usize>,
        /// Of the `inner` component.
        inner: Vec<usize>,
    },
    /// The `inner` component was added for another `outer` component, of this class.
    AddedForAnother(Name),
}

impl fmt::Display for InnerMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InnerMismatch::Rank { outer, inner } => {
                let dimensions = if *outer == 1 { "dimension" } else { "dimensions" };
                write!(f, "it has {outer} {dimensions}, and the `inner` one has {inner}")
            }
            InnerMismatch::Class(why) => write!(f, "{why}"),
            InnerMismatch::Size { outer, inner } => {
                write!(f, "it has size {outer:?}, and the `inner` one has {inner:?}")
            }
            InnerMismatch::AddedForAnother(class) => write!(
                f,
                "none is declared, and another `outer` component of that name is a `{class}`"
            ),
        }
    }
}
