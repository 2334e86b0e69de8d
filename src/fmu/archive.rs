//! The ZIP archive of an FMU. Sole user of `zip`.
//!
//! In: names and contents. Out: the bytes of the archive; equal contents give equal bytes. And back: the
//! description, and the files of the archive in a folder, within bounds.

use std::fs::{self, File};
use std::io::{Cursor, Read, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::cause::FmuCause;

/// The name of the description in an archive.
pub const DESCRIPTION: &str = "modelDescription.xml";
/// Largest description, bytes: some hundred thousand variables.
const LARGEST_DESCRIPTION: u64 = 256 << 20;
/// Largest sum of all files that are unpacked, bytes.
const LARGEST_CONTENT: u64 = 4 << 30;
/// Most entries of an archive.
const MOST_ENTRIES: usize = 100_000;

/// Packs files, in this order.
pub fn pack(files: &[(String, &[u8])]) -> Result<Vec<u8>, String> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
        .unix_permissions(0o644);
    for (name, content) in files {
        // Loaders map libraries: they are executable.
        let options = match name.starts_with("binaries/") {
            true => options.unix_permissions(0o755),
            false => options,
        };
        writer.start_file(name.as_str(), options).map_err(|e| e.to_string())?;
        writer.write_all(content).map_err(|e| e.to_string())?;
    }
    writer.finish().map(Cursor::into_inner).map_err(|e| e.to_string())
}

/// An archive that was opened, all of whose names are harmless.
pub struct Archive {
    path: String,
    zip: ZipArchive<Cursor<Vec<u8>>>,
    /// The names of its files.
    pub names: Vec<String>,
}

impl Archive {
    /// Opens an archive. Names that lead out of a folder, links, and too many entries are refused.
    pub fn open(file: &Path) -> Result<Archive, FmuCause> {
        let path = file.display().to_string();
        let unreadable =
            |e: std::io::Error| FmuCause::FileOfFmu { path: path.clone(), why: e.to_string() };
        let bytes = fs::read(file).map_err(unreadable)?;
        let broken = |e: zip::result::ZipError| FmuCause::BadArchive {
            path: path.clone(),
            why: e.to_string(),
        };
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        if zip.len() > MOST_ENTRIES {
            let what = format!("{} entries", zip.len());
            return Err(FmuCause::TooLarge { path, what });
        }
        let mut names = Vec::with_capacity(zip.len());
        for k in 0..zip.len() {
            let entry = zip.by_index_raw(k).map_err(broken)?;
            let name = entry.name().map_err(broken)?.into_owned();
            let is_harmless = entry.enclosed_name().is_some()
                && !name.split(['/', '\\']).any(|part| part == "..")
                && !name.starts_with('/')
                && !name.contains(['\\', ':'])
                && !entry.is_symlink();
            if !is_harmless {
                return Err(FmuCause::UnsafeEntry { path, entry: name });
            }
            if !name.ends_with('/') {
                names.push(name);
            }
        }
        Ok(Archive { path, zip, names })
    }

    /// The text of the description.
    pub fn description(&mut self) -> Result<String, FmuCause> {
        let path = self.path.clone();
        let broken = |why: String| FmuCause::BadArchive { path: path.clone(), why };
        let entry = self.zip.by_name(DESCRIPTION);
        let entry = entry.map_err(|_| broken(format!("it has no `{DESCRIPTION}`")))?;
        let mut bytes = Vec::new();
        let read = entry.take(LARGEST_DESCRIPTION + 1).read_to_end(&mut bytes);
        read.map_err(|e| broken(format!("`{DESCRIPTION}`: {e}")))?;
        if bytes.len() as u64 > LARGEST_DESCRIPTION {
            let what = format!("a description of more than {} MB", LARGEST_DESCRIPTION >> 20);
            return Err(FmuCause::TooLarge { path, what });
        }
        String::from_utf8(bytes).map_err(|_| broken(format!("`{DESCRIPTION}` is not UTF-8")))
    }

    /// Writes the files whose names are `wanted` below a folder.
    pub fn unpack(&mut self, folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<(), FmuCause> {
        let path = self.path.clone();
        let mut total = 0;
        for name in self.names.iter().filter(|name| wanted(name)) {
            let broken = |why: String| FmuCause::BadArchive {
                path: path.clone(),
                why: format!("`{name}`: {why}"),
            };
            let target = folder.join(name);
            let unwritable = |e: std::io::Error| FmuCause::FileOfFmu {
                path: target.display().to_string(),
                why: e.to_string(),
            };
            if let Some(parent) = target.parent() {
                fs::create_dir_all(parent).map_err(unwritable)?;
            }
            let entry = self.zip.by_name(name).map_err(|e| broken(e.to_string()))?;
            let mut out = File::create(&target).map_err(unwritable)?;
            let mut entry = entry.take(LARGEST_CONTENT - total + 1);
            total += std::io::copy(&mut entry, &mut out).map_err(|e| broken(e.to_string()))?;
            if total > LARGEST_CONTENT {
                let what = format!("more than {} GB of files", LARGEST_CONTENT >> 30);
                return Err(FmuCause::TooLarge { path, what });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::cause::Cause;

    fn refused(files: &[(String, &[u8])], cut: usize) -> &'static str {
        let name = format!("mocc-archive-{}-{cut}.fmu", std::process::id());
        let path = std::env::temp_dir().join(name);
        let mut bytes = pack(files).unwrap();
        bytes.truncate(bytes.len() - cut);
        fs::write(&path, bytes).unwrap();
        let found = Archive::open(&path).and_then(|mut a| a.description());
        fs::remove_file(&path).unwrap();
        found.err().map_or("", |cause| cause.entry().code)
    }

    #[test]
    fn archives_that_are_cut_or_lead_outside_are_refused() {
        let good = (DESCRIPTION.to_owned(), &b"<x/>"[..]);
        assert_eq!(refused(std::slice::from_ref(&good), 0), "");
        assert_eq!(refused(std::slice::from_ref(&good), 30), "MO1305");
        assert_eq!(refused(&[("other.xml".to_owned(), b"")], 1), "MO1305");
        for (k, name) in
            ["../evil.so", "resources/../../evil", "/evil", "a\\..\\b"].iter().enumerate()
        {
            let files = [good.clone(), ((*name).to_owned(), &b""[..])];
            let found = refused(&files, 0);
            assert_eq!(found, "MO1306", "{k}: {name}");
        }
    }
}
