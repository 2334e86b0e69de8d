//! The compiled model in `resources/` of an FMU.
//!
//! In: a program and the token of its FMU. Out: bytes with a version and the token, and the program again, or
//! why not.

use crate::base::wire::{Reader, Wire};
use crate::ir::program::Program;

/// The name of the file in `resources/`.
pub const FILE: &str = "model.mocc";
/// The first bytes of the file.
const MAGIC: &[u8; 8] = b"mocc-fmu";
/// The version of the bytes that follow. Another version of mocc may write others.
const VERSION: u32 = 6;

/// Why there is no program.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum PackageError {
    /// Not the file of a compiled model.
    #[error("`resources/{FILE}` does not hold a compiled model")]
    NotAPackage,
    /// Written by another version.
    #[error(
        "the model was compiled for version {0} of the runtime, which is version {VERSION}: export the model again, or copy the runtime of that version into `binaries`"
    )]
    OtherVersion(u32),
    /// The token differs.
    #[error(
        "the token `{given}` is not that of the compiled model, `{own}`: `modelDescription.xml` and `resources` belong to different FMUs"
    )]
    OtherToken {
        /// The token of the importer.
        given: String,
        /// The token of the model.
        own: String,
    },
    /// The bytes are damaged.
    #[error("the compiled model is damaged")]
    Damaged,
}

/// The bytes of a program.
pub fn write(program: &Program, token: &str) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    VERSION.write(&mut bytes);
    token.to_owned().write(&mut bytes);
    program.write(&mut bytes);
    bytes
}

/// The program with this token.
pub fn read(bytes: &[u8], token: &str) -> Result<Program, PackageError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(PackageError::NotAPackage)?;
    let mut reader = Reader::new(rest);
    let version = u32::read(&mut reader).map_err(|_| PackageError::Damaged)?;
    if version != VERSION {
        return Err(PackageError::OtherVersion(version));
    }
    let own = String::read(&mut reader).map_err(|_| PackageError::Damaged)?;
    if own != token {
        return Err(PackageError::OtherToken { given: token.to_owned(), own });
    }
    let program = Program::read(&mut reader).map_err(|_| PackageError::Damaged)?;
    if reader.is_at_end() { Ok(program) } else { Err(PackageError::Damaged) }
}

/// A token for these bytes: equal contents have equal tokens.
pub fn token_of(bytes: &[u8]) -> String {
    let hash = |seed: u64| {
        let step = |h: u64, b: &u8| (h ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3);
        bytes.iter().fold(0xcbf2_9ce4_8422_2325 ^ seed, step)
    };
    let (a, b) = (hash(0), hash(0x9e37_79b9_7f4a_7c15));
    format!(
        "{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}",
        a >> 32,
        (a >> 16) & 0xffff,
        a & 0xffff,
        b >> 48,
        b & 0xffff_ffff_ffff
    )
}
