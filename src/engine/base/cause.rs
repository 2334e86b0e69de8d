//! Causes of diagnostics. Each stage declares its causes in one enum with [`causes!`](crate::base::cause::causes): a
//! variant for each cause, with its code, message, remedy and section of the Modelica specification.

use std::any::Any;
use std::fmt::Debug;

/// Whether a diagnostic prevents the model from running.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Severity {
    /// The model cannot be compiled or run.
    Error,
    /// The model runs, but the user should know.
    Warning,
}

/// The facts about a cause that do not depend on the model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Entry {
    /// Stable code, such as `MO0201`; a retired code is never used again.
    pub code: &'static str,
    /// Whether the model can still be compiled or run.
    pub severity: Severity,
    /// One sentence about the cause, for lists of codes.
    pub summary: &'static str,
    /// The section of the Modelica specification that is violated, such as `4.7`; empty if the rule is not the
    /// specification's.
    pub section: &'static str,
}

/// Why a diagnostic is reported. Implemented by [`causes!`](crate::base::cause::causes).
pub trait Cause: Any + Debug + Send + Sync {
    /// Its entry in the registry.
    fn entry(&self) -> &'static Entry;
    /// One sentence, lower case, without full stop, in the user's names.
    fn message(&self) -> String;
    /// How to repair the model.
    fn help(&self) -> Option<String>;
}

/// Declares the causes of a stage: an enum that implements [`Cause`] and the table of its entries, `ENTRIES`.
///
/// The arguments of `help` may be left out, or replaced by `remedy`, an expression of type `Option<String>`.
///
/// ```
/// mocc_engine::base::cause::causes! {
///     /// Causes found by the class lookup.
///     pub enum LookupCause {
///         /// No class has this name.
///         error MO0201 UnknownClass { path: String } (section "5.3")
///             => ("there is no class `{path}`"), help("check the spelling");
///         /// A class is declared and never used.
///         warning MO0999 Unused => ("the class is never used");
///     }
/// }
/// use mocc_engine::base::cause::Cause;
/// let cause = LookupCause::UnknownClass { path: "A.B".to_owned() };
/// assert_eq!(cause.entry().code, "MO0201");
/// assert_eq!(cause.message(), "there is no class `A.B`");
/// assert_eq!(LookupCause::ENTRIES.len(), 2);
/// ```
#[macro_export]
macro_rules! causes {
    (
        $(#[$outer:meta])*
        $visibility:vis enum $name:ident {
            $(
                $(#[doc = $summary:literal])+
                $severity:ident $code:ident $variant:ident $({ $($field:ident : $type:ty),* $(,)? })?
                $((section $section:literal))?
                => ($($message:tt)+) $(, help($($help:tt)+))? $(, remedy($remedy:expr))? ;
            )*
        }
    ) => {
        $(#[$outer])*
        #[derive(Clone, Debug)]
        $visibility enum $name {
            $(
                $(#[doc = $summary])+
                $variant $({
                    $(
                        #[allow(missing_docs)]
                        $field: $type
                    ),*
                })?,
            )*
        }

        impl $name {
            /// The entries of these causes in the registry, in the order of the variants.
            $visibility const ENTRIES: &'static [$crate::base::cause::Entry] = &[
                $($crate::base::cause::causes!(@entry $severity $code ($($summary)+) ($($section)?)),)*
            ];
        }

        impl $crate::base::cause::Cause for $name {
            fn entry(&self) -> &'static $crate::base::cause::Entry {
                match self {
                    $(Self::$variant $({ $($field: _),* })? => {
                        const ENTRY: $crate::base::cause::Entry =
                            $crate::base::cause::causes!(@entry $severity $code ($($summary)+) ($($section)?));
                        &ENTRY
                    })*
                }
            }
            #[allow(unused_variables)]
            fn message(&self) -> String {
                match self {
                    $(Self::$variant $({ $($field),* })? => format!($($message)+),)*
                }
            }
            #[allow(unused_variables)]
            fn help(&self) -> Option<String> {
                match self {
                    $(Self::$variant $({ $($field),* })? =>
                        $crate::base::cause::causes!(@help $(($($help)+))? $([$remedy])?),)*
                }
            }
        }
    };
    (@entry $severity:ident $code:ident ($($summary:literal)+) ($($section:literal)?)) => {
        $crate::base::cause::Entry {
            code: stringify!($code),
            severity: $crate::base::cause::causes!(@severity $severity),
            summary: concat!($($summary),+).trim_ascii(),
            section: concat!($($section)?),
        }
    };
    (@severity error) => { $crate::base::cause::Severity::Error };
    (@severity warning) => { $crate::base::cause::Severity::Warning };
    (@help) => { None };
    (@help ($($help:tt)+)) => { Some(format!($($help)+)) };
    (@help [$remedy:expr]) => { $remedy };
}

pub use causes;
