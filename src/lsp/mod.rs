//! Models in an editor: the language server protocol, version 3.17.
//!
//! *In:* messages of a client ([`message`]), which changes texts and asks about them. *Out:* diagnostics after each
//! change, and answers ([`server`], [`protocol`], [`asked`]): outline and folds ([`outline`]), colours ([`colours`]), declarations and candidates
//! ([`answers`]), also in other files ([`workspace`]), other names ([`rename`]), classes and calls ([`symbols`]), keys of
//! plans ([`plan_keys`]), hints and lenses ([`lenses`]), repairs ([`repairs`]). Positions count lines and UTF-16 units from
//! 0 ([`position`]). Answers and checks are computed on threads of their own ([`jobs`]), from copies of the texts.
//!
//! The few types of the protocol that are used are built as JSON; the crates that declare all of them would double the
//! time that a build takes.

pub mod answers;
pub mod asked;
pub mod colours;
pub mod diagnostics;
pub mod jobs;
pub mod lenses;
pub mod message;
pub mod outline;
pub mod plan_keys;
pub mod plans;
pub mod position;
pub mod protocol;
pub mod rename;
pub mod repairs;
pub mod server;
pub mod symbols;
pub mod workspace;
